// Device arrays and the account of device memory.
#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "host/base/error.hpp"
#include "host/base/numbers.hpp"
#include "host/gpu/buffer.hpp"

namespace hemiray {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20U;

}  // namespace

TEST_CASE("a buffer gives back what was written, whole and in part") {
  Context context(choose_device(""));
  std::vector<std::uint32_t> data(1000);
  std::iota(data.begin(), data.end(), 5U);
  Buffer<std::uint32_t> buffer(context, "numbers", std::span<const std::uint32_t>(data));
  CHECK(buffer.size() == 1000);
  CHECK(buffer.bytes() == 4000);
  CHECK(buffer.name() == "numbers");
  CHECK(buffer.read() == data);
  CHECK(buffer.read(10, 3) == std::vector<std::uint32_t>{15, 16, 17});
  CHECK(buffer.read(1000, 0).empty());
  const std::vector<std::uint32_t> start = {1, 2, 3};
  buffer.write(start);
  CHECK(buffer.read(0, 5) == std::vector<std::uint32_t>{1, 2, 3, 8, 9});
}

TEST_CASE("clearing reaches every byte, over more than one piece") {
  Context context(choose_device(""));
  const std::vector<unsigned char> ones((std::size_t{2} << 20U) + 12345, 0xff);
  Buffer<unsigned char> buffer(context, "bytes", std::span<const unsigned char>(ones));
  buffer.clear();
  CHECK(buffer.read() == std::vector<unsigned char>(ones.size(), 0));
}

TEST_CASE("an empty buffer is a buffer") {
  Context context(choose_device(""));
  Buffer<std::uint64_t> buffer(context, "nothing", 0);
  CHECK(buffer.size() == 0);
  CHECK(buffer.bytes() == sizeof(std::uint64_t));
  CHECK(buffer.handle()() != nullptr);
  CHECK(buffer.read().empty());
  buffer.write({});
  buffer.clear();
  const Buffer<std::uint64_t> none;
  CHECK(none.size() == 0);
  CHECK(none.name().empty());
}

TEST_CASE("the memory account counts what lives, and remembers the peak") {
  Context context(choose_device(""));
  CHECK(context.allocated_bytes() == 0);
  {
    const Buffer<float> a(context, "a", 100);
    CHECK(context.allocated_bytes() == 400);
    {
      const Buffer<double> b(context, "b", 1000);
      CHECK(context.allocated_bytes() == 8400);
    }
    CHECK(context.allocated_bytes() == 400);
    CHECK(context.peak_bytes() == 8400);
  }
  CHECK(context.allocated_bytes() == 0);
  const Buffer<float> later(context, "later", 10);  // below the peak
  CHECK(context.peak_bytes() == 8400);
}

TEST_CASE("the memory of a large buffer serves the next one") {
  Context context(choose_device(""));
  if (context.device().kind != DeviceKind::cpu) return;
  { const Buffer<char> small(context, "small", 2 * kMiB); }
  CHECK(context.idle_bytes() == 0);
  void* memory = nullptr;
  const auto place = [](const Buffer<char>& buffer) {
    void* host = nullptr;
    buffer.handle().getInfo(CL_MEM_HOST_PTR, &host);
    return host;
  };
  {
    const Buffer<char> a(context, "a", 9 * kMiB);
    memory = place(a);
    CHECK(context.idle_bytes() == 0);
  }
  CHECK(context.idle_bytes() == 10 * kMiB);  // in whole huge pages
  {
    const Buffer<char> b(context, "b", 8 * kMiB);
    CHECK(place(b) == memory);
    CHECK(context.idle_bytes() == 0);
    const Buffer<char> c(context, "c", 5 * kMiB);
  }
  CHECK(context.idle_bytes() == (10 + 6) * kMiB);
  {
    // Too large for what waits, which has to make room: 16 MiB were in use, 14 are.
    const Buffer<char> d(context, "d", 12 * kMiB + kMiB / 2);
    CHECK(context.idle_bytes() == 0);
  }
  const Buffer<char> e(context, "e", 8 * kMiB);  // what would waste a third of itself is left to wait for others
  CHECK(context.idle_bytes() <= 8 * kMiB);
}

TEST_CASE("memory that waits and what is in use hold no more than was in use at the peak") {
  IdleHostMemory idle;
  std::vector<HostMemory> used;
  std::uint64_t in_use = 0, peak = 0, reused_larger = 0;
  for (std::size_t i = 0; i < 60; i++) {
    const std::size_t asked = (4 + i * 7 % 11) * kMiB;
    const std::uint64_t waited = idle.bytes();
    used.push_back(idle.take(asked));
    REQUIRE(used.back().memory);
    CHECK(used.back().capacity >= asked);
    if (idle.bytes() < waited && used.back().capacity >= asked + 2 * kMiB) reused_larger++;
    in_use += used.back().capacity;
    peak = std::max(peak, in_use);
    CHECK(idle.bytes() + in_use <= peak);
    for (std::size_t freed = 0; i % 10 == 9 && freed < 8; freed++) {
      const std::uint64_t capacity = used.front().capacity, waiting = idle.bytes();
      in_use -= capacity;
      idle.keep(std::move(used.front()));
      used.erase(used.begin());
      CHECK(idle.bytes() == waiting + capacity);
      CHECK(idle.bytes() + in_use <= peak);
    }
  }
  CHECK(reused_larger > 0);
}

TEST_CASE("moving a buffer moves its share of the account") {
  Context context(choose_device(""));
  const std::vector<std::uint32_t> ones(10, 1U), twos(20, 2U);
  Buffer<std::uint32_t> a(context, "a", std::span<const std::uint32_t>(ones));
  Buffer<std::uint32_t> b(context, "b", std::span<const std::uint32_t>(twos));
  CHECK(context.allocated_bytes() == 120);
  Buffer<std::uint32_t> c(std::move(a));
  CHECK(context.allocated_bytes() == 120);
  CHECK(c.read() == ones);
  c = std::move(b);
  CHECK(context.allocated_bytes() == 80);
  CHECK(c.read() == twos);
  CHECK(c.name() == "b");
  std::swap(c, b);
  CHECK(b.read() == twos);
  b = Buffer<std::uint32_t>();
  CHECK(context.allocated_bytes() == 0);
}

TEST_CASE("more than one allocation may hold: what is needed and what is there") {
  Context context(choose_device(""));
  const std::uint64_t most = context.device().max_allocation_bytes;
  const auto allocate = [&] { const Buffer<char> buffer(context, "the film", static_cast<std::size_t>(most) + 1); };
  CHECK_THROWS_AS(allocate(), DeviceError);
  CHECK_THROWS_WITH(allocate(), Catch::Contains("the film needs " + format_bytes(most + 1)) &&
                                    Catch::Contains("allows " + format_bytes(most)));
  CHECK(context.allocated_bytes() == 0);
  const auto absurd = [&] { const Buffer<char> buffer(context, "the film", std::size_t{1} << 60U); };
  CHECK_THROWS_AS(absurd(), DeviceError);
}

TEST_CASE("more than the device has: what is needed beside what is in use, and what is there") {
  DeviceInfo device = choose_device("");
  device.global_bytes = 10000;
  Context context(device);
  const Buffer<char> held(context, "held", 6000);
  const auto allocate = [&] { const Buffer<char> buffer(context, "the tree", 4001); };
  CHECK_THROWS_AS(allocate(), DeviceError);
  CHECK_THROWS_WITH(allocate(), Catch::Contains("the tree needs " + format_bytes(4001)) &&
                                    Catch::Contains(format_bytes(6000) + " in use") &&
                                    Catch::Contains("has " + format_bytes(10000)));
  CHECK(context.allocated_bytes() == 6000);
  const Buffer<char> fits(context, "fits", 4000);
  CHECK(context.allocated_bytes() == 10000);
}

}  // namespace hemiray
