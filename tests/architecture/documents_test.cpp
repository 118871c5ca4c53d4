#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <unordered_set>
#include <vector>

namespace fascia::documents_test {

// A machine can check of documents that links lead somewhere, that names in backticks exist, that commands can be
// pasted.
namespace {

namespace fs = std::filesystem;
const fs::path kRoot = fascia::test::source_dir();

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file) << "cannot read " << path;
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

/// A document, in which fenced blocks stand apart.
struct Document {
  fs::path path;
  std::string prose, blocks;
};

Document document_of(const fs::path& path) {
  Document document{path, {}, {}};
  std::istringstream lines(text_of(path));
  bool in_block = false;
  for (std::string line; std::getline(lines, line);) {
    const bool fence = line.starts_with("```");
    if (fence) in_block = !in_block;
    if (!fence) (in_block ? document.blocks : document.prose) += line + "\n";
  }
  return document;
}

std::vector<Document> documents() {
  std::vector<Document> all;
  for (const char* name : {"README.md", "CONTRIBUTING.md", "scenes/README.md"})
    all.push_back(document_of(kRoot / name));
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") all.push_back(document_of(entry.path()));
  return all;
}

/// Texts between `open` and the next `close`, again and again.
std::vector<std::string> between(const std::string& text, const std::string& open, char close) {
  std::vector<std::string> found;
  for (std::size_t begin = text.find(open); begin != std::string::npos;) {
    begin += open.size();
    const std::size_t end = std::min(text.find(close, begin), text.size());
    found.push_back(text.substr(begin, end - begin));
    begin = text.find(open, end + 1);
  }
  return found;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Anchors of a document's headings, as GitHub makes them.
std::set<std::string> anchors_of(const fs::path& path) {
  std::set<std::string> anchors;
  std::istringstream lines(document_of(path).prose);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with('#')) continue;
    std::string anchor;
    for (const char c : line.substr(std::min(line.find_first_not_of("# "), line.size()))) {
      if (c == ' ') anchor += '-';
      if (is_word(c) || c == '-') anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    std::string own = anchor;
    for (int again = 1; !anchors.insert(own).second; ++again) own = anchor + "-" + std::to_string(again);
  }
  return anchors;
}

std::set<std::string> project_folders() {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(kRoot)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_directory() && !name.starts_with(".") && name != "build" && name != "results") names.insert(name);
  }
  return names;
}

/// Adds the words of a text, and `name(` for what is called or declared there.
void add_words(std::unordered_set<std::string>& words, const std::string& text) {
  for (auto begin = std::find_if(text.begin(), text.end(), is_word); begin != text.end();) {
    const auto end = std::find_if_not(begin, text.end(), is_word);
    words.insert(std::string(begin, end));
    if (end != text.end() && (*end == '(' || *end == '<')) words.insert(std::string(begin, end) + "(");
    begin = std::find_if(end, text.end(), is_word);
  }
}

/// The words of sources, scenes and scripts, and the names of files.
std::unordered_set<std::string> words_of_project() {
  static const std::set<std::string> endings = {".cpp", ".hpp", ".cu", ".cuh", ".txt", ".sh", ".toml", ".py", ".cmake"};
  std::unordered_set<std::string> words;
  for (const std::string& folder : project_folders()) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const fs::path& path = entry.path();
      words.insert(path.stem().string());
      if (endings.contains(path.extension().string()) && path.stem() != "documents_test")
        add_words(words, text_of(path));
    }
  }
  for (const char* script : {"run", "check"}) add_words(words, text_of(kRoot / script));
  return words;
}

/// Words in capitals stand for names that the reader gives.
bool has_placeholder(const std::string& text) {
  static const std::regex form(R"((^|[^A-Za-z])[A-Z]{2,}([^A-Za-z]|$)|\.\.\.|…)");
  return std::regex_search(text, form);
}

TEST(Documents, ReadmeIsShort) { EXPECT_LT(std::ranges::count(text_of(kRoot / "README.md"), '\n'), 90); }

TEST(Documents, LinksLeadSomewhere) {
  for (const Document& document : documents()) {
    for (const std::string& link : between(document.prose, "](", ')')) {
      if (link.find("://") != std::string::npos) continue;
      const std::size_t hash = link.find('#');
      const fs::path target = hash == 0 ? document.path : document.path.parent_path() / link.substr(0, hash);
      EXPECT_TRUE(fs::exists(target)) << document.path << ": " << link;
      const bool whole = hash == std::string::npos;
      EXPECT_TRUE(whole || anchors_of(target).contains(link.substr(hash + 1))) << document.path << ": " << link;
    }
  }
}

TEST(Documents, NamedPathsExist) {
  static const std::regex form(R"(([a-z]+)/[\w./-]*[\w/])");
  const std::set<std::string> tops = project_folders();
  for (const Document& document : documents()) {
    for (const std::string& span : between(document.prose, "`", '`')) {
      for (const std::string& word : words_in(span)) {
        std::smatch match;
        if (!std::regex_match(word, match, form) || !tops.contains(match[1]) || has_placeholder(word)) continue;
        const auto exists = [&word](const char* ending) { return fs::exists(kRoot / (word + ending)); };
        EXPECT_TRUE(exists("") || exists(".hpp") || exists(".cpp")) << document.path << ": " << word;
      }
    }
  }
}

// Types and snake_case names, qualified or not; what has brackets behind it must be called or declared somewhere.
TEST(Documents, NamesInBackticksOccurInTheSources) {
  static const std::regex form(R"((\w+::)*([A-Za-z]\w*)(<[^>]*>)?(\(.*\))?)");
  static const std::regex checked(R"([A-Z]\w*[a-z]\w*|[a-z]\w*_\w*)");
  const std::unordered_set<std::string> words = words_of_project();
  for (const Document& document : documents()) {
    if (document.path.filename() == "validation.md") continue;
    for (const std::string& span : between(document.prose, "`", '`')) {
      std::smatch match;
      if (!std::regex_match(span, match, form) || has_placeholder(span)) continue;
      EXPECT_TRUE(!match[4].matched || words.contains(match[2].str() + "(")) << document.path << ": " << span;
      std::unordered_set<std::string> parts;
      add_words(parts, span.substr(0, span.find('(')));
      for (const std::string& part : parts)
        EXPECT_TRUE(!std::regex_match(part, checked) || words.contains(part)) << document.path << ": " << span;
    }
  }
}

TEST(Documents, CommandsOfTheReadmeCanBePasted) {
  const Document readme = document_of(kRoot / "README.md");
  std::vector<std::string> commands = between(readme.prose, "`", '`');
  std::istringstream lines(readme.blocks);
  for (std::string line; std::getline(lines, line);) commands.push_back(line);
  for (const std::string& command : commands) {
    if (!command.starts_with("./")) continue;
    EXPECT_FALSE(has_placeholder(command)) << command;
    for (const std::string& word : words_in(command))
      EXPECT_TRUE(!word.ends_with(".toml") || fs::exists(kRoot / word)) << command;
  }
}

}  // namespace

}  // namespace fascia::documents_test
