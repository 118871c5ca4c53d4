#include "app/run/process_memory.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace fascia::process_memory_test {
namespace {

namespace fs = std::filesystem;

/// A tree of control groups in a folder of its own.
class Groups : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "fascia groups XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    root_ = name;
  }
  void TearDown() override { fs::remove_all(root_); }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((root_ / name).parent_path());
    std::ofstream(root_ / name) << text << "\n";
  }
  double left(const std::string& groups) const {
    write("self", groups);
    return app::memory_left_by_groups(root_ / "self", root_);
  }
  fs::path root_;
};

TEST_F(Groups, LeaveAllWhereNoneLimits) {
  EXPECT_TRUE(std::isinf(left("0::/")));
  write("a/memory.max", "max");
  write("a/memory.current", "1000");
  EXPECT_TRUE(std::isinf(left("0::/a")));
}

TEST_F(Groups, OfTheSecondVersionLeaveTheLeastOfAllAround) {
  write("a/memory.max", "5000");
  write("a/memory.current", "3000");
  write("a/b/memory.max", "2500");
  write("a/b/memory.current", "1000");
  write("a/b/memory.stat", "anon 100\ninactive_file 600");
  EXPECT_EQ(left("0::/a/b"), 2000);
  write("a/b/memory.current", "500");
  write("a/b/memory.stat", "inactive_file 0");
  EXPECT_EQ(left("0::/a/b"), 2000);
  write("a/memory.current", "6000");
  EXPECT_EQ(left("0::/a/b"), 0);
}

TEST_F(Groups, OfTheFirstVersionAreThoseOfTheMemoryController) {
  write("memory/job/memory.limit_in_bytes", "9000");
  write("memory/job/memory.usage_in_bytes", "4000");
  write("memory/job/memory.stat", "cache 5\ntotal_inactive_file 500");
  EXPECT_EQ(left("5:cpuset:/\n4:memory:/job\n1:cpu:/other\n0::/"), 5500);
}

TEST(ProcessMemory, KnowsWhatItHolds) {
  const double before = app::resident_memory();
  const std::vector<char> block(64 << 20, 1);
  EXPECT_NEAR(app::resident_memory() - before, 64 << 20, 2 << 20) << static_cast<int>(block[7]);
  EXPECT_GE(app::peak_memory(), 64 << 20);
  EXPECT_GT(app::free_memory().bytes, 0);
}

}  // namespace
}  // namespace fascia::process_memory_test
