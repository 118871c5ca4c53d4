#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace fascia::public_headers_test {

/// Programs that embed the library see a few headers, which mean the same whatever flags these programs are compiled
/// with.
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Headers that cmake/install.cmake installs.
std::set<std::string> installed() {
  const std::string text = text_of(test::source_dir() / "cmake/install.cmake");
  const std::size_t begin = text.find("set(FASCIA_PUBLIC_HEADERS"), end = text.find(')', begin);
  const std::string list = text.substr(begin, end - begin);
  static const std::regex header(R"re([\w/]+\.hpp)re");
  return {std::sregex_token_iterator(list.begin(), list.end(), header), {}};
}

TEST(PublicHeaders, IncludeInstalledOnesAndNoLibraryButTheStandardOne) {
  const std::set<std::string> headers = installed();
  EXPECT_TRUE(headers.contains("fascia/stepper.hpp"));
  static const std::regex ours(R"re(#include "([^"]+)")re"), others(R"re(#include <([^>]+)>)re");
  for (const std::string& header : headers) {
    const std::string text = text_of(test::source_dir() / header);
    for (std::sregex_iterator i(text.begin(), text.end(), ours), end; i != end; ++i)
      EXPECT_TRUE(headers.contains((*i)[1])) << header << " includes " << (*i)[1] << ", which is not installed";
    for (std::sregex_iterator i(text.begin(), text.end(), others), end; i != end; ++i)
      EXPECT_EQ((*i)[1].str().find_first_of("./"), std::string::npos)
          << header << " includes <" << (*i)[1] << ">; public headers include the standard library alone";
  }
}

/// Vectors of a processor have other sizes, and other names, under other flags.
TEST(PublicHeaders, KnowNoInstructionSet) {
  static const std::regex leaks(R"re(\bLanes\b|\bBatch\b|__AVX|vector_size|immintrin)re");
  for (const std::string& header : installed())
    EXPECT_FALSE(std::regex_search(text_of(test::source_dir() / header), leaks)) << header;
}

}  // namespace

}  // namespace fascia::public_headers_test
