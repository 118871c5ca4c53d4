#pragma once

#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::random_scenes {

using Json = nlohmann::ordered_json;
using Vector = std::array<double, 3>;

/// Random values that are the same with every standard library.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : engine_(seed * 0x9E3779B97F4A7C15u + 1) {}

  double uniform(double from, double to) {
    return from + (to - from) * static_cast<double>(engine_() >> 11U) * 0x1.0p-53;
  }
  /// 10 to the power of a number between the two.
  double decades(double from, double to) { return std::pow(10, uniform(from, to)); }
  /// A whole number, limits included.
  int whole(int from, int to) { return from + static_cast<int>(engine_() % static_cast<std::uint64_t>(to - from + 1)); }
  bool chance(double part) { return uniform(0, 1) < part; }
  template <class T>
  T pick(const std::vector<T>& of) {
    return of[static_cast<std::size_t>(whole(0, static_cast<int>(of.size()) - 1))];
  }
  /// A vector of a length in any direction, or in one out of four cases along an axis.
  Vector directed(double length) {
    if (chance(0.25)) {
      Vector along{};
      along[static_cast<std::size_t>(whole(0, 2))] = chance(0.5) ? length : -length;
      return along;
    }
    Vector v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    const double size = std::hypot(v[0], v[1], v[2]);
    for (double& c : v) c *= length / size;
    return v;
  }
  /// One of the words that the schema takes at a path, such as "bodies.*.model"; "*" is any name or entry.
  std::string word(std::string_view path);

 private:
  std::mt19937_64 engine_;
};

}  // namespace fascia::random_scenes
