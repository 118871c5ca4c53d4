#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace fascia::precompiled_test {

// Where there is no compiler cache, as at a first ./run, every file of the library begins with the headers that its
// CMakeLists.txt precompiles, included or not. The builds of ./check have a cache and precompile nothing; this looks
// for what would not compile there: a name of one of those headers, taken again in an unnamed namespace.
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = fascia::test::source_dir();

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Headers of the project that a folder's library precompiles. @param folder  with a CMakeLists.txt that may say so
std::vector<std::string> precompiled_in(const std::string& folder) {
  const std::string text = text_of(kRoot / folder / "CMakeLists.txt");
  std::smatch found;
  if (std::regex_search(text, found, std::regex(R"(PRECOMPILED_FOR fascia_(\w+)\))")) && found[1] != folder)
    return precompiled_in(found[1]);
  if (!std::regex_search(text, found, std::regex(R"(PRECOMPILE ([^)]*)\))"))) return {};
  std::istringstream words(found[1]);
  std::vector<std::string> headers;
  for (std::string word; words >> word;)
    if (word.front() != '<') headers.push_back(word);
  return headers;
}

/// A header and all that it includes of the project.
void reach(const std::string& header, std::set<std::string>& reached) {
  if (!fs::exists(kRoot / header) || !reached.insert(header).second) return;
  static const std::regex include(R"re(#include "([^"]+)")re");
  const std::string text = text_of(kRoot / header);
  for (std::sregex_iterator it(text.begin(), text.end(), include), end; it != end; ++it) reach((*it)[1], reached);
}

/// Types and constants that a file defines at the level of a namespace, as "fascia::app::Name".
/// @param unnamed  in an unnamed namespace, as if it had no braces; else in named ones alone
std::set<std::string> names_in(const std::string& file, bool unnamed) {
  static const std::regex opens(R"(^namespace\s*([\w:]*)\s*\{)"), closes(R"(^\}\s*// namespace)");
  static const std::regex defines(
      R"(^(?:(?:struct|class|enum class|enum|using)\s+(\w+)\b(?!\s*;)|(?:inline )?constexpr [^={]*?\b(k[A-Z]\w*)\b).*)");
  std::set<std::string> names;
  std::vector<std::string> open;
  std::istringstream lines(text_of(kRoot / file));
  std::smatch found;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_search(line, found, opens)) {
      open.push_back(found[1]);
    } else if (std::regex_search(line, closes) && !open.empty()) {
      open.pop_back();
    } else if (std::regex_match(line, found, defines)) {
      const bool inside = std::find(open.begin(), open.end(), "") != open.end();
      if (inside != unnamed) continue;
      std::string name;
      for (const std::string& space : open) name += space.empty() ? "" : space + "::";
      names.insert(name + (found[1].matched ? found[1] : found[2]).str());
    }
  }
  return names;
}

TEST(PrecompiledHeaders, HaveNoNameThatASourceTakesAgain) {
  int sources = 0;
  for (const std::string folder : {"core", "meshless", "fem", "shells", "coupling", "assembly"}) {
    std::set<std::string> headers;
    for (const std::string& header : precompiled_in(folder)) reach(header, headers);
    EXPECT_FALSE(headers.empty()) << folder << " precompiles nothing, or its CMakeLists.txt is not understood";
    std::map<std::string, std::string> taken;
    for (const std::string& header : headers)
      for (const std::string& name : names_in(header, false)) taken[name] = header;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const std::string file = fs::relative(entry.path(), kRoot).generic_string();
      if (!file.ends_with(".cpp")) continue;
      ++sources;
      // A name of an enclosing namespace is hidden, and not ambiguous, but for its own.
      for (const std::string& name : names_in(file, true))
        EXPECT_FALSE(taken.contains(name)) << file << " defines " << name << " again, which stands in " << taken[name];
    }
  }
  EXPECT_GT(sources, 170);
}

}  // namespace

}  // namespace fascia::precompiled_test
