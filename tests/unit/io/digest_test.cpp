#include "io/digest.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <gtest/gtest.h>

namespace fascia::io::digest_test {
namespace {

/// The examples of FIPS 180-4.
TEST(Digest, IsThatOfTheStandard) {
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Digest, OfAFileIsThatOfItsBytes) {
  const samples::TemporaryDirectory directory;
  const std::string bytes(200000, 'x');
  write_file(directory.path() / "a", bytes);
  EXPECT_EQ(sha256_of(directory.path() / "a"), sha256(bytes));
  EXPECT_THROW(sha256_of(directory.path() / "b"), FileError);
}

}  // namespace
}  // namespace fascia::io::digest_test
