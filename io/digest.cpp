#include "io/digest.hpp"

#include "core/base/errors.hpp"

#include <sha256.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

namespace fascia::io {
namespace {

class Digest {
 public:
  Digest() { SHA256_Init(&state_); }
  void add(const char* bytes, std::size_t count) {
    SHA256_Update(&state_, reinterpret_cast<const std::uint8_t*>(bytes), count);
  }
  std::string text() {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
    SHA256_End(&state_, digits.data());
    return digits.data();
  }

 private:
  SHA2_CTX state_{};
};

}  // namespace

std::string sha256(std::string_view bytes) {
  Digest digest;
  digest.add(bytes.data(), bytes.size());
  return digest.text();
}

std::string sha256_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw FileError(file.string() + ": cannot be opened: " + std::strerror(errno));
  Digest digest;
  std::array<char, 1 << 16> part;
  while (stream.read(part.data(), part.size()), stream.gcount() > 0)
    digest.add(part.data(), static_cast<std::size_t>(stream.gcount()));
  if (stream.bad()) throw FileError(file.string() + ": cannot be read: " + std::strerror(errno));
  return digest.text();
}

}  // namespace fascia::io
