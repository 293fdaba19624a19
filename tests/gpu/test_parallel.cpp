// Prefix sum and radix sort on the device against the standard library.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "host/gpu/parallel.hpp"
#include "tests/support/profile_file.hpp"

namespace hemiray {
namespace {

using Keys = std::vector<std::uint64_t>;
using Values = std::vector<std::uint32_t>;

constexpr std::uint32_t kSizes[] = {0,   1,    2,    3,    7,    8,    9,    15,    16,    17,    31,    32,
                                    33,  63,   64,   65,   127,  128,  129,  255,   256,   257,   511,   512,
                                    513, 1023, 1024, 1025, 4095, 4096, 4097, 65535, 65536, 65537, 100007};

constexpr unsigned kIndexBits = 17;  // enough for the places of the largest count

// Both forms of the sort and of the scan: by work-items, and by work-groups, of which some get no keys.
void with_both_forms(const std::function<void(Context&, Parallel&)>& check) {
  for (const std::string groups : {"0", "5"}) {
    const test::ProfileFile profile(test::ProfileFile::for_all(R"("sort_groups": )" + groups));
    Context context(choose_device(""));
    Parallel parallel(context);
    INFO(groups << " work-groups");
    check(context, parallel);
  }
}

// Sorts the first `count` keys on the device; the array may be longer.
Keys sort_on_device(Context& context, Parallel& parallel, const Keys& keys, std::uint32_t count, unsigned first_bit,
                    unsigned bits) {
  Buffer<std::uint64_t> device_keys(context, "keys", std::span<const std::uint64_t>(keys));
  Buffer<std::uint64_t> scratch(context, "scratch", keys.size());
  parallel.sort(device_keys, scratch, count, first_bit, bits);
  Keys sorted = device_keys.read();
  sorted.resize(count);
  return sorted;
}

// The keys must come out as std::stable_sort orders them by their bits [first_bit, first_bit + bits): whole keys are
// compared, so whatever lies in the other bits comes along.
void check_sort(Context& context, Parallel& parallel, const Keys& keys, unsigned first_bit, unsigned bits) {
  const auto count = static_cast<std::uint32_t>(keys.size());
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  const auto digits = [&](std::uint64_t key) { return key >> first_bit & mask; };
  Keys expected = keys;
  std::stable_sort(expected.begin(), expected.end(),
                   [&](std::uint64_t a, std::uint64_t b) { return digits(a) < digits(b); });
  INFO(count << " keys, " << bits << " bits from " << first_bit << " on");
  const bool sorted = sort_on_device(context, parallel, keys, count, first_bit, bits) == expected;
  REQUIRE(sorted);
}

// The key's own place in its low bits: sorted by the others, it shows whether equal keys keep their order.
Keys with_places(Keys keys) {
  for (std::size_t i = 0; i < keys.size(); i++) keys[i] = keys[i] >> kIndexBits << kIndexBits | i;
  return keys;
}

Keys random_keys(std::uint32_t count, std::uint64_t seed, std::uint64_t mask = ~std::uint64_t{0}) {
  std::mt19937_64 random(seed);
  Keys keys(count);
  for (std::uint64_t& key : keys) key = random() & mask;
  return keys;
}

}  // namespace

TEST_CASE("the scan is the exclusive prefix sum, and the total follows") {
  with_both_forms([](Context& context, Parallel& parallel) {
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
  });
}

TEST_CASE("the sort is std::stable_sort for random keys of many counts") {
  with_both_forms([](Context& context, Parallel& parallel) {
    for (const std::uint32_t count : kSizes) {
      check_sort(context, parallel, random_keys(count, count + 1U), 0, 64);
      check_sort(context, parallel, with_places(random_keys(count, count + 2U)), kIndexBits, 12);
    }
  });
}

TEST_CASE("the sort is std::stable_sort for keys with a pattern") {
  with_both_forms([](Context& context, Parallel& parallel) {
    for (const std::uint32_t count : {2U, 255U, 256U, 257U, 1000U, 100000U}) {
      Keys keys = random_keys(count, 9);
      std::sort(keys.begin(), keys.end());
      check_sort(context, parallel, keys, 0, 64);  // sorted already
      std::reverse(keys.begin(), keys.end());
      check_sort(context, parallel, keys, 0, 64);                                         // reversed
      check_sort(context, parallel, Keys(count, 0x0123456789abcdefU), 0, 64);             // all equal
      check_sort(context, parallel, random_keys(count, 10, 0x3U), 0, 64);                 // few distinct
      check_sort(context, parallel, random_keys(count, 11, 0xff00000000000000U), 0, 64);  // the last digit only
      check_sort(context, parallel, with_places(random_keys(count, 12, 0xffU << kIndexBits)), kIndexBits, 8);
      Keys outlier(count, 0);
      outlier.front() = ~std::uint64_t{0};
      check_sort(context, parallel, outlier, 0, 64);
    }
  });
}

TEST_CASE("only the bits asked for count, wherever they lie") {
  with_both_forms([](Context& context, Parallel& parallel) {
    const Keys keys = random_keys(5000, 12);
    for (const unsigned bits : {0U, 1U, 2U, 7U, 10U, 11U, 12U, 21U, 22U, 23U, 33U, 34U, 44U, 45U, 63U}) {
      for (const unsigned first : {0U, 1U, 13U, 31U, 33U}) {
        if (first + bits <= 64) check_sort(context, parallel, keys, first, bits);
      }
      check_sort(context, parallel, keys, 64 - bits - (bits == 0 ? 1 : 0), bits);  // the highest
    }
  });
}

TEST_CASE("the sort is std::stable_sort with any number of chunks") {
  for (const std::string chunks : {"1", "2", "7", "300"}) {
    const test::ProfileFile profile(
        test::ProfileFile::for_all(R"("chunks": )" + chunks + R"(, "chunk_local_size": 4)"));
    Context context(choose_device(""));
    Parallel parallel(context);
    INFO(chunks << " chunks");
    for (const std::uint32_t count : {2U, 6U, 7U, 8U, 1000U, 65537U}) {
      check_sort(context, parallel, with_places(random_keys(count, 17)), kIndexBits, 33);
    }
  }
}

TEST_CASE("work-groups of any size and number sort as std::stable_sort does") {
  const DeviceInfo device = choose_device("");
  for (const std::uint32_t local_size : {1U, 24U, 256U, 1024U}) {
    if (local_size > device.max_work_group_size) continue;
    for (const std::uint32_t groups : {1U, 2U, 67U}) {
      DeviceProfile profile = class_profile(device);
      profile.local_size = local_size;
      profile.sort_groups = groups;
      Context context(device, profile);
      Parallel parallel(context);
      INFO(groups << " groups of " << local_size);
      for (const std::uint32_t count : {2U, 255U, 256U, 257U, 2047U, 2048U, 2049U, 100007U}) {
        check_sort(context, parallel, with_places(random_keys(count, 18)), kIndexBits, 23);
      }
      Keys equal(30000, 77);
      check_sort(context, parallel, with_places(equal), kIndexBits, 7);
    }
  }
}

TEST_CASE("no more keys are sorted than asked for") {
  with_both_forms([](Context& context, Parallel& parallel) {
    const Keys keys = random_keys(1000, 14);
    Keys expected(keys.begin(), keys.begin() + 700);
    std::sort(expected.begin(), expected.end());
    CHECK(sort_on_device(context, parallel, keys, 700, 0, 64) == expected);
  });
}

TEST_CASE("sorting takes no memory of its own") {
  with_both_forms([](Context& context, Parallel& parallel) {
    const std::uint64_t before = context.allocated_bytes();
    check_sort(context, parallel, random_keys(1000, 15), 0, 64);
    CHECK(context.allocated_bytes() == before);
    CHECK(context.peak_bytes() == before + 2 * 1000 * sizeof(std::uint64_t));
  });
}

}  // namespace hemiray
