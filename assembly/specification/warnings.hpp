#pragma once

#include "assembly/specification/region.hpp"

#include <optional>
#include <string>
#include <vector>

namespace fascia {

/// What a user should know of a scene or a result, although nothing is wrong.
struct Warning {
  std::string name;  ///< by which a scene silences it
  std::string text;
  std::optional<Place> place;

  /// "KEY: text [name]", as summary.json has it.
  std::string summary() const;
};

/// The warnings of a run in the order in which they arise, without those that its scene silences.
class Warnings {
 public:
  explicit Warnings(std::vector<std::string> silenced = {}) : silenced_(std::move(silenced)) {}

  void add(const std::string& name, std::string text);
  void add(const std::string& name, const Place& place, std::string text);
  void add(const Warnings& others);

  /// Those that came since the last call, for whoever shows them.
  std::vector<Warning> take_new();

  std::size_t size() const { return all_.size(); }
  bool silences(const std::string& name) const;
  std::size_t silenced() const { return left_out_; }  ///< how many were
  std::vector<std::string> summary() const;

 private:
  void add(Warning warning);

  std::vector<std::string> silenced_;
  std::vector<Warning> all_;
  std::size_t taken_ = 0, left_out_ = 0;
};

}  // namespace fascia
