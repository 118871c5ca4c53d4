#include "io/result_writer.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <set>

namespace fascia::io::result_directory_test {
namespace {

namespace fs = std::filesystem;
using samples::content;
using samples::TemporaryDirectory;

const char* const summary = "{ \"fascia\": \"0.1.0\" }";

/// Names in a directory, hidden ones included.
std::set<std::string> names(const fs::path& directory) {
  std::set<std::string> result;
  for (const auto& entry : fs::directory_iterator(directory)) result.insert(entry.path().filename().string());
  return result;
}

void make_result(const fs::path& target, const std::string& text) {
  ResultDirectory result(target);
  write_text(result.path() / "summary.json", summary);
  write_text(result.path() / "a.txt", text);
  result.commit();
}

std::string file_error(const fs::path& target) {
  try {
    ResultDirectory result(target);
  } catch (const FileError& e) {
    return e.what();
  }
  return "no FileError";
}

TEST(ResultDirectory, appears_on_commit_with_its_parents) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "results" / "beam";
  {
    ResultDirectory result(target);
    write_text(result.path() / "a.txt", "new");
    EXPECT_FALSE(fs::exists(target));
    EXPECT_EQ(result.path().filename().string(), ".beam.partial-" + std::to_string(getpid()));
    result.commit();
  }
  EXPECT_EQ(names(directory.path() / "results"), std::set<std::string>{"beam"});
  EXPECT_EQ(content(target / "a.txt"), "new");
}

TEST(ResultDirectory, replaces_an_older_result_in_whole) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  write_text(target / "more.txt", "old");
  make_result(directory.path() / "beam/", "new");
  EXPECT_EQ(names(directory.path()), std::set<std::string>{"beam"});
  EXPECT_EQ(names(target), (std::set<std::string>{"summary.json", "a.txt"}));
  EXPECT_EQ(content(target / "a.txt"), "new");
}

TEST(ResultDirectory, leaves_the_older_result_without_commit) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  {
    ResultDirectory result(target);
    write_text(result.path() / "a.txt", "new");
  }
  EXPECT_EQ(names(directory.path()), std::set<std::string>{"beam"});
  EXPECT_EQ(content(target / "a.txt"), "old");
}

TEST(ResultDirectory, restores_the_older_result_when_commit_fails) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  ResultDirectory result(target);
  fs::remove_all(result.path());
  EXPECT_THROW(result.commit(), FileError);
  EXPECT_EQ(names(directory.path()), std::set<std::string>{"beam"});
  EXPECT_EQ(content(target / "a.txt"), "old");
}

TEST(ResultDirectory, replaces_nothing_else) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "precious";
  fs::create_directory(target);
  EXPECT_EQ(file_error(target), "no FileError") << "an empty directory may be replaced";

  directory.write("precious/thesis.txt", "years");
  EXPECT_EQ(file_error(target).rfind(fs::canonical(target).string() + ": exists and is no result of this program", 0),
            0u)
      << file_error(target);
  for (const char* other : {"{ \"name\": \"x\" }", "[1, 2]", "{ \"fascia\"", "\xff\xfe"}) {
    directory.write("precious/summary.json", other);
    EXPECT_NE(file_error(target), "no FileError") << other;
  }
  directory.write("file", "x");
  EXPECT_NE(file_error(directory.path() / "file").find("exists and is no directory"), std::string::npos);
  EXPECT_NE(file_error(directory.path() / "file" / "below"), "no FileError");
  EXPECT_NE(file_error("/"), "no FileError");
  EXPECT_EQ(content(target / "thesis.txt"), "years");
}

TEST(ResultDirectory, looks_again_before_it_replaces) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  ResultDirectory result(target);
  fs::create_directory(target);
  write_text(target / "thesis.txt", "years");
  EXPECT_THROW(result.commit(), FileError);
  EXPECT_EQ(content(target / "thesis.txt"), "years");
}

TEST(ResultDirectory, follows_a_link) {
  const TemporaryDirectory directory;
  make_result(directory.path() / "real", "old");
  fs::create_directory_symlink(directory.path() / "real", directory.path() / "link");
  make_result(directory.path() / "link", "new");
  EXPECT_EQ(names(directory.path()), (std::set<std::string>{"link", "real"}));
  EXPECT_EQ(content(directory.path() / "real" / "a.txt"), "new");
}

/// The id of a process that has ended.
pid_t dead_process() {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

TEST(ResultDirectory, removes_what_dead_processes_left) {
  const TemporaryDirectory directory;
  const std::string dead = std::to_string(dead_process()), alive = std::to_string(getppid());
  const std::vector<std::string> left{".beam.partial-" + dead, ".beam.partial-" + alive, ".beam.partial-12x",
                                      ".beam.partial-", ".board.partial-" + dead};
  for (const std::string& name : left) {
    fs::create_directory(directory.path() / name);
    write_text(directory.path() / name / "a.txt", "x");
  }
  make_result(directory.path() / "beam", "new");
  EXPECT_EQ(names(directory.path()), (std::set<std::string>{"beam", ".beam.partial-" + alive, ".beam.partial-12x",
                                                            ".beam.partial-", ".board.partial-" + dead}));
}

TEST(ResultDirectory, puts_back_the_result_of_a_process_that_died_in_commit) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  fs::rename(target, directory.path() / (".beam.older-" + std::to_string(dead_process())));
  { const ResultDirectory result(target); }
  EXPECT_EQ(names(directory.path()), std::set<std::string>{"beam"});
  EXPECT_EQ(content(target / "a.txt"), "old");
}

}  // namespace
}  // namespace fascia::io::result_directory_test
