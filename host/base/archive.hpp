// Plain values as bytes, written and read back by the same calls.
#pragma once

#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/base/error.hpp"

namespace hemiray {

/// Writes to bytes of its own, or reads from others', which must outlive it: who lists his members once, as
/// archive.value(a); archive.list(b), both saves and restores them. In the machine's byte order. Reading throws
/// InputError where there are fewer bytes than asked for.
class Archive {
 public:
  Archive() = default;
  explicit Archive(std::span<const std::uint8_t> from) : from_(from), reads_(true) {}

  [[nodiscard]] bool reads() const { return reads_; }

  template <typename T>
  void value(T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    raw(&v, sizeof v);
  }

  template <typename T>
  void list(std::vector<T>& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::uint64_t count = v.size();
    value(count);
    if (reads_) {
      if (count > from_.size() / sizeof(T)) fail();
      v.resize(static_cast<std::size_t>(count));
    }
    raw(v.data(), v.size() * sizeof(T));
  }

  [[nodiscard]] std::vector<std::uint8_t> take() { return std::move(bytes_); }

  /// To be called where everything was read. Throws InputError if bytes are left.
  void end() const {
    if (!from_.empty()) fail();
  }

  [[noreturn]] static void fail() { throw InputError("its parts do not fit together"); }

 private:
  void raw(void* data, std::size_t size) {
    if (size == 0) return;
    if (!reads_) {
      const std::size_t before = bytes_.size();
      bytes_.resize(before + size);
      std::memcpy(bytes_.data() + before, data, size);
      return;
    }
    if (size > from_.size()) fail();
    std::memcpy(data, from_.data(), size);
    from_ = from_.subspan(size);
  }

  std::vector<std::uint8_t> bytes_;
  std::span<const std::uint8_t> from_;
  bool reads_ = false;
};

}  // namespace hemiray
