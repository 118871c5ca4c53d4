#pragma once

#include "app/report/report_directory.hpp"

#include <filesystem>
#include <string>

namespace fascia::app {

/// The directory that a verification fills: verify.json, verify.csv, verify.html, runs/NAME of each run, and scenes/ of
/// those whose text stands in a case file.
class VerifyDirectory : public ReportDirectory {
 public:
  /// @throws FileError  like its base
  explicit VerifyDirectory(std::filesystem::path path)
      : ReportDirectory(std::move(path), "verify", {"runs", "scenes", "verify.html", "verify.csv"}) {}

  std::filesystem::path run(const std::string& name) const { return path() / "runs" / name; }
  std::filesystem::path scene(const std::string& name) const { return path() / "scenes" / (name + ".toml"); }
};

}  // namespace fascia::app
