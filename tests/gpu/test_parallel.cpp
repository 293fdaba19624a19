// Prefix sum and radix sort on the device against the standard library.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "host/gpu/parallel.hpp"

namespace hemiray {
namespace {

using Keys = std::vector<std::uint64_t>;
using Values = std::vector<std::uint32_t>;

constexpr std::uint32_t kSizes[] = {0,   1,    2,    3,    7,    8,    9,    15,    16,    17,    31,    32,
                                    33,  63,   64,   65,   127,  128,  129,  255,   256,   257,   511,   512,
                                    513, 1023, 1024, 1025, 4095, 4096, 4097, 65535, 65536, 65537, 100000};

// Sorts on the device with values 0, 1, 2, ...; the array may be longer than what is sorted.
struct Sorted {
  Keys keys;
  Values values;
};

Sorted sort_on_device(Context& context, Parallel& parallel, const Keys& keys, std::uint32_t count, unsigned bits) {
  Values values(keys.size());
  std::iota(values.begin(), values.end(), 0U);
  Buffer<std::uint64_t> device_keys(context, "keys", std::span<const std::uint64_t>(keys));
  Buffer<std::uint32_t> device_values(context, "values", std::span<const std::uint32_t>(values));
  parallel.sort(device_keys, device_values, count, bits);
  return {device_keys.read(), device_values.read()};
}

// The first `count` keys must come out as std::stable_sort orders them by their low `bits` bits; equal keys keep their
// order, which the values show.
void check_sort(Context& context, Parallel& parallel, const Keys& keys, unsigned bits) {
  const auto count = static_cast<std::uint32_t>(keys.size());
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  Values order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return (keys[a] & mask) < (keys[b] & mask); });
  Keys expected;
  for (const std::uint32_t i : order) expected.push_back(keys[i]);
  const Sorted sorted = sort_on_device(context, parallel, keys, count, bits);
  INFO(count << " keys, " << bits << " bits");
  REQUIRE(sorted.values == order);
  REQUIRE(sorted.keys == expected);
}

Keys random_keys(std::uint32_t count, std::uint64_t seed, std::uint64_t mask = ~std::uint64_t{0}) {
  std::mt19937_64 random(seed);
  Keys keys(count);
  for (std::uint64_t& key : keys) key = random() & mask;
  return keys;
}

}  // namespace

TEST_CASE("the scan is the exclusive prefix sum, and the total follows") {
  Context context(choose_device(""));
  Parallel parallel(context);
  std::mt19937 random(1);
  for (const std::uint32_t count : kSizes) {
    Values input(count + 3);
    for (std::uint32_t& v : input) v = static_cast<std::uint32_t>(random());  // sums wrap, as unsigned ones do
    Buffer<std::uint32_t> values(context, "values", std::span<const std::uint32_t>(input));
    parallel.exclusive_scan(values, count);
    Values expected = input;
    std::exclusive_scan(input.begin(), input.begin() + count, expected.begin(), 0U);
    expected[count] = std::accumulate(input.begin(), input.begin() + count, 0U);
    INFO(count << " values");
    REQUIRE(values.read() == expected);  // what lies behind is left alone
  }
}

TEST_CASE("the sort is std::stable_sort for random keys of many counts") {
  Context context(choose_device(""));
  Parallel parallel(context);
  for (const std::uint32_t count : kSizes) check_sort(context, parallel, random_keys(count, count + 1U), 64);
}

TEST_CASE("the sort is std::stable_sort for keys with a pattern") {
  Context context(choose_device(""));
  Parallel parallel(context);
  for (const std::uint32_t count : {2U, 255U, 256U, 257U, 1000U, 100000U}) {
    Keys keys = random_keys(count, 9);
    std::sort(keys.begin(), keys.end());
    check_sort(context, parallel, keys, 64);  // sorted already
    std::reverse(keys.begin(), keys.end());
    check_sort(context, parallel, keys, 64);                                         // reversed
    check_sort(context, parallel, Keys(count, 0x0123456789abcdefU), 64);             // all equal
    check_sort(context, parallel, random_keys(count, 10, 0x3U), 64);                 // few distinct
    check_sort(context, parallel, random_keys(count, 11, 0xff00000000000000U), 64);  // the last digit only
    Keys outlier(count, 0);
    outlier.front() = ~std::uint64_t{0};
    check_sort(context, parallel, outlier, 64);
  }
}

TEST_CASE("only the low bits count, whole digits of them") {
  Context context(choose_device(""));
  Parallel parallel(context);
  const Keys keys = random_keys(5000, 12);
  for (const unsigned bits : {8U, 16U, 24U, 32U, 48U, 64U}) check_sort(context, parallel, keys, bits);
  // A number of bits that is no whole digit sorts by the digit it lies in: keys with nothing above are in order.
  for (const unsigned bits : {1U, 7U, 31U, 33U, 63U}) {
    check_sort(context, parallel, random_keys(5000, 13, (std::uint64_t{1} << bits) - 1), bits);
  }
}

TEST_CASE("no more keys are sorted than asked for") {
  Context context(choose_device(""));
  Parallel parallel(context);
  const Keys keys = random_keys(1000, 14);
  const Sorted sorted = sort_on_device(context, parallel, keys, 700, 64);
  Keys expected(keys.begin(), keys.begin() + 700);
  std::sort(expected.begin(), expected.end());
  CHECK(std::equal(expected.begin(), expected.end(), sorted.keys.begin()));
}

TEST_CASE("sorting gives its scratch back") {
  Context context(choose_device(""));
  Parallel parallel(context);
  const std::uint64_t before = context.allocated_bytes();
  check_sort(context, parallel, random_keys(1000, 15), 64);
  CHECK(context.allocated_bytes() == before);
  CHECK(context.peak_bytes() >= 2 * 1000 * (sizeof(std::uint64_t) + sizeof(std::uint32_t)));
}

}  // namespace hemiray
