#include "app/results/warnings.hpp"

#include "app/run/messages.hpp"

#include <algorithm>

namespace fascia::app {

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

void Warnings::tell(const std::filesystem::path& scene) {
  for (; told_ < all_.size(); ++told_) {
    const Warning& w = all_[told_];
    if (w.place && w.place->line > 0)
      say("{}:{}:{}: warning: {}\n", w.place->file, w.place->line, w.place->column, w.summary());
    else
      say("{}: warning: {}\n", scene.string(), w.summary());
  }
}

std::vector<std::string> Warnings::summary() const {
  std::vector<std::string> texts;
  texts.reserve(all_.size());
  for (const Warning& w : all_) texts.push_back(w.summary());
  return texts;
}

}  // namespace fascia::app
