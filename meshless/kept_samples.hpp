#pragma once

#include "core/base/clock.hpp"
#include "meshless/cloud_build.hpp"
#include "meshless/sample_store.hpp"

#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

/// Samples of matter that take long and depend on little: they are looked for in a store before they are made.
namespace fascia {

/// Writes all that samples follow from as bytes, number by number. A domain's functions are described by its surface
/// and by what they say of places in its bounding box.
class SampleDescription {
 public:
  SampleDescription(std::string_view what, const MatterParts& parts, const SampleChoice& choice);

  template <class T>
  SampleDescription& add(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    return *this;
  }
  SampleDescription& add(const Vec3d& x) { return add(x[0]).add(x[1]).add(x[2]); }
  template <class T>
  SampleDescription& add_all(std::span<const T> values) {
    add(values.size());
    for (const T& value : values) add(value);
    return *this;
  }
  std::string_view text() const { return text_; }

 private:
  void add_solid(const SolidDomain& solid);
  void add_mesh(const TriangleMesh& mesh);
  void add_choice(const SampleChoice& choice);

  std::string text_;
};

/// Samples with the mean distance that they were made for.
template <class Sample>
struct KeptSamples {
  double spacing = 0;  ///< [m]
  std::vector<Sample> samples;
};

/// Takes samples from the store, or makes them and keeps them there.
/// @param store  null: they are made  @param make  returns KeptSamples<Sample>
template <class Sample, class Make>
KeptSamples<Sample> kept_or_made(const SampleStore* store, const SampleDescription& description, const Make& make) {
  static_assert(std::is_trivially_copyable_v<Sample>);
  if (!store) return make();
  if (const std::optional<std::string> bytes = store->find(description.text());
      bytes && bytes->size() >= sizeof(double) && (bytes->size() - sizeof(double)) % sizeof(Sample) == 0) {
    KeptSamples<Sample> kept;
    std::memcpy(&kept.spacing, bytes->data(), sizeof(double));
    kept.samples.resize((bytes->size() - sizeof(double)) / sizeof(Sample));
    if (!kept.samples.empty())
      std::memcpy(kept.samples.data(), bytes->data() + sizeof(double), bytes->size() - sizeof(double));
    return kept;
  }
  const Clock::time_point start = Clock::now();
  KeptSamples<Sample> made = make();
  if (!store->wants(seconds_since(start))) return made;
  std::string bytes(reinterpret_cast<const char*>(&made.spacing), sizeof(double));
  bytes.append(reinterpret_cast<const char*>(made.samples.data()), made.samples.size() * sizeof(Sample));
  store->keep(description.text(), bytes);
  return made;
}

}  // namespace fascia
