// SHA-256, of OpenSSL.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace hemiray {

/// Of bytes that come in parts. Throws std::bad_alloc.
class Sha256 {
 public:
  using Digest = std::array<std::uint8_t, 32>;

  Sha256();
  void add(std::span<const std::uint8_t> bytes);
  /// Of all bytes added; to be called once, last.
  [[nodiscard]] Digest digest();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// In lower-case hexadecimal.
std::string to_hex(const Sha256::Digest& digest);
std::string sha256(std::string_view text);

}  // namespace hemiray
