#pragma once

#include "app/compare/time_pairs.hpp"
#include "io/result_writer.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace fascia::app {

/// The states that a result has saved, read when they are asked for.
class SavedStates {
 public:
  /// @throws FileError, InputError  see read_collection(), collection_of()
  SavedStates(const std::filesystem::path& directory, const nlohmann::ordered_json& summary);

  const std::vector<double>& times() const { return times_; }
  /// In the order of the .pvd.
  const std::vector<std::string>& bodies() const { return bodies_; }
  bool has(const std::string& body) const;

  /// A body's points, cells and point fields at a time. Between two states points and fields are interpolated.
  /// @throws FileError, InputError  a .vtu that is missing, damaged or of another mesh than the one before it
  std::shared_ptr<const io::VisualMesh> at(const std::string& body, const TimePlace& time);

 private:
  std::shared_ptr<const io::VisualMesh> state(const std::string& body, std::size_t index);

  std::vector<double> times_;
  std::vector<std::string> bodies_;
  std::vector<std::map<std::string, std::filesystem::path>> files_;  ///< by time, by body
  /// The last two of each body: what comes next is often one of them.
  std::map<std::string, std::vector<std::pair<std::size_t, std::shared_ptr<const io::VisualMesh>>>> recent_;
};

}  // namespace fascia::app
