#include "io/result_directory.hpp"

#include "core/base/errors.hpp"
#include "io/files.hpp"
#include "tests/unit/io/mesh_samples.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <set>

namespace fascia::io::result_directory_test {
namespace {

namespace fs = std::filesystem;
using samples::content;
using samples::TemporaryDirectory;

const ResultNames kNames{"scene", {"beam"}};
const std::set<std::string> kFiles{"summary.json", "probes.csv", "scene.pvd", "beam_00000.vtu"};

/// Names in a directory, hidden ones included.
std::set<std::string> names(const fs::path& directory) {
  std::set<std::string> result;
  for (const auto& entry : fs::directory_iterator(directory)) result.insert(entry.path().filename().string());
  return result;
}

void fill(const fs::path& target, const std::string& text) {
  write_file(target / "summary.json",
             R"({ "fascia": "0.1.0", "scene": "scene.toml", "bodies": { "beam": {} }, "of": ")" + text + "\" }");
  for (const char* file : {"probes.csv", "scene.pvd", "beam_00000.vtu"}) write_file(target / file, text);
}

void make_result(const fs::path& target, const std::string& text) {
  ResultDirectory result(target, kNames);
  fill(result.path(), text);
  result.show();
}

/// A process does this, and dies.
void in_a_process_that_dies(const std::function<void()>& work) {
  const pid_t child = fork();
  if (child == 0) {
    work();
    _exit(0);
  }
  waitpid(child, nullptr, 0);
}

std::string file_error(const fs::path& target) {
  try {
    ResultDirectory result(target, kNames);
  } catch (const FileError& e) {
    return e.what();
  }
  return "no FileError";
}

TEST(ResultDirectory, IsMadeWithItsParentsAndLockedWhileItIsFilled) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "results" / "beam";
  {
    ResultDirectory result(target, kNames);
    fill(result.path(), "new");
    EXPECT_TRUE(fs::exists(target / DirectoryLock::kName));
    result.show();
  }
  EXPECT_EQ(names(target), kFiles);
  EXPECT_EQ(content(target / "probes.csv"), "new");
}

TEST(ResultDirectory, WithoutAnythingToShowGoesAgain) {
  const TemporaryDirectory directory;
  { const ResultDirectory result(directory.path() / "beam", kNames); }
  EXPECT_TRUE(names(directory.path()).empty());
  {
    ResultDirectory result(directory.path() / "beam", kNames);
    fill(result.path(), "kept");
    result.keep();
  }
  EXPECT_EQ(names(directory.path() / "beam"), kFiles);
}

TEST(ResultDirectory, TakesThePlaceOfAnOlderResultOnceItIsShown) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  write_file(target / "beam_00001.vtu", "old");
  write_file(target / ".beam_00002.vtu.part", "old");
  write_file(target / "scene.png", "old");
  make_result(directory.path() / "beam/", "new");
  EXPECT_EQ(names(target), kFiles);
  EXPECT_EQ(content(target / "probes.csv"), "new");
}

TEST(ResultDirectory, PutsTheOlderResultBackWhereItIsNeverShown) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  for (const bool filled : {false, true}) {
    ResultDirectory result(target, kNames);
    if (filled) fill(result.path(), "new");
    result.keep();
  }
  EXPECT_EQ(names(target), kFiles);
  EXPECT_EQ(content(target / "probes.csv"), "old");
}

TEST(ResultDirectory, LeavesForeignFilesAlone) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  const std::set<std::string> foreign{"notes.txt",      "view.pvsm",       "beam_1.vtu",
                                      "beam_0000x.vtu", "other_00000.vtu", ".part"};
  for (const std::string& file : foreign) write_file(target / file, "mine");
  make_result(target, "new");
  std::set<std::string> all = kFiles;
  all.insert(foreign.begin(), foreign.end());
  EXPECT_EQ(names(target), all);
  for (const std::string& file : foreign) EXPECT_EQ(content(target / file), "mine");
}

TEST(ResultDirectory, RefusesToOverwriteAForeignFile) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  write_file(target / "other_00000.vtu", "mine");
  try {
    ResultDirectory result(target, {"scene", {"other"}});
    ADD_FAILURE();
  } catch (const FileError& e) {
    EXPECT_NE(std::string(e.what()).find("other_00000.vtu: would be overwritten"), std::string::npos) << e.what();
  }
  EXPECT_EQ(content(target / "probes.csv"), "old");
  EXPECT_EQ(content(target / "other_00000.vtu"), "mine");
  EXPECT_EQ(names(target).size(), 5u);
}

TEST(ResultDirectory, ReplacesNothingElse) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "precious";
  fs::create_directory(target);
  EXPECT_EQ(file_error(target), "no FileError") << "an empty directory may be filled";
  EXPECT_TRUE(fs::exists(target));

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
  EXPECT_NE(file_error("").find("has no name"), std::string::npos);
  EXPECT_EQ(names(target), (std::set<std::string>{"summary.json", "thesis.txt"}));
}

TEST(ResultDirectory, FollowsALink) {
  const TemporaryDirectory directory;
  make_result(directory.path() / "real", "old");
  fs::create_directory_symlink(directory.path() / "real", directory.path() / "link");
  make_result(directory.path() / "link", "new");
  EXPECT_EQ(names(directory.path()), (std::set<std::string>{"link", "real"}));
  EXPECT_EQ(content(directory.path() / "real" / "probes.csv"), "new");
}

/// Before it had anything to show, with no file, some files or all of them; and after.
TEST(ResultDirectory, ComesBackAfterAProcessThatWasKilled) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  const std::vector<std::function<void(const fs::path&)>> deeds{[](const fs::path&) {},
                                                                [](const fs::path& at) { fill(at, "new"); },
                                                                [](const fs::path& at) {
                                                                  fill(at, "new");
                                                                  write_file(at / "beam_00001.vtu", "new");
                                                                  write_file(at / ".beam_00002.vtu.part", "new");
                                                                }};
  for (const auto& deed : deeds) {
    in_a_process_that_dies([&] {
      ResultDirectory result(target, kNames);
      deed(result.path());
      _exit(0);
    });
    EXPECT_TRUE(fs::exists(target / ".fascia.older"));
    { const ResultDirectory result(target, kNames); }
    EXPECT_EQ(names(target), kFiles);
    EXPECT_EQ(content(target / "probes.csv"), "old");
  }
  in_a_process_that_dies([&] {
    ResultDirectory result(target, kNames);
    fill(result.path(), "new");
    result.show();
    _exit(0);
  });
  { const ResultDirectory result(target, kNames); }
  EXPECT_EQ(names(target), kFiles);
  EXPECT_EQ(content(target / "probes.csv"), "new");
}

/// While files are set aside or put back, one after another: summary.json goes first and comes last.
TEST(ResultDirectory, ComesBackFromBetweenTwoFiles) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam", older = target / ".fascia.older";
  for (const std::set<std::string>& aside :
       {std::set<std::string>{}, {"summary.json"}, {"summary.json", "probes.csv"}, kFiles}) {
    fs::remove_all(target);
    make_result(target, "old");
    fs::create_directory(older);
    for (const std::string& file : aside) fs::rename(target / file, older / file);
    { const ResultDirectory result(target, kNames); }
    EXPECT_EQ(names(target), kFiles) << aside.size();
    EXPECT_EQ(content(target / "probes.csv"), "old");
  }
}

TEST(ResultDirectory, IsOfOneProcessAtATime) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  const ResultDirectory first(target, kNames);
  const std::string why = file_error(target);
  EXPECT_NE(why.find("another run writes its result there (process " + std::to_string(getpid()) + " on "),
            std::string::npos)
      << why;
}

TEST(ResultDirectory, LocksOfTheDeadCountForNothingOfOtherMachinesAreTold) {
  const TemporaryDirectory directory;
  const fs::path target = directory.path() / "beam";
  make_result(target, "old");
  in_a_process_that_dies([&] {
    const DirectoryLock lock(target);
    _exit(0);
  });
  EXPECT_TRUE(fs::exists(target / DirectoryLock::kName));
  EXPECT_EQ(file_error(target), "no FileError");

  write_file(target / DirectoryLock::kName, "12 elsewhere\n");
  const std::string why = file_error(target);
  EXPECT_NE(why.find("process 12 on elsewhere writes its result there, or died; where it did, remove "),
            std::string::npos)
      << why;
  EXPECT_EQ(content(target / DirectoryLock::kName), "12 elsewhere\n");
  EXPECT_EQ(content(target / "probes.csv"), "old");
}

}  // namespace
}  // namespace fascia::io::result_directory_test
