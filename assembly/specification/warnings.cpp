#include "assembly/specification/warnings.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace fascia {

std::string Warning::summary() const {
  return fmt::format("{}{} [{}]", place && !place->key.empty() ? place->key + ": " : "", text, name);
}

bool Warnings::silences(const std::string& name) const {
  return std::find(silenced_.begin(), silenced_.end(), name) != silenced_.end();
}

void Warnings::add(Warning warning) {
  if (silences(warning.name))
    ++left_out_;
  else
    all_.push_back(std::move(warning));
}

void Warnings::add(const std::string& name, std::string text) { add(Warning{name, std::move(text), {}}); }

void Warnings::add(const std::string& name, const Place& place, std::string text) {
  add(Warning{name, std::move(text), place});
}

void Warnings::add(const Warnings& others) {
  for (const Warning& w : others.all_) add(w);
  left_out_ += others.left_out_;
}

std::vector<Warning> Warnings::take_new() {
  std::vector<Warning> untold(all_.begin() + static_cast<std::ptrdiff_t>(taken_), all_.end());
  taken_ = all_.size();
  return untold;
}

std::vector<std::string> Warnings::summary() const {
  std::vector<std::string> texts;
  texts.reserve(all_.size());
  for (const Warning& w : all_) texts.push_back(w.summary());
  return texts;
}

}  // namespace fascia
