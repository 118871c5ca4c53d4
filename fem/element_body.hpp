#pragma once

#include "core/body/model_body.hpp"
#include "fem/locator.hpp"

#include <functional>
#include <optional>

namespace fascia {

/// large_strain: the law of the material.
enum class ElementFormulation { large_strain, corotational, linear };

/// Against volumetric locking of linear tetrahedra; automatic: averaged above a Poisson ratio of 0.45.
enum class ElementLocking { automatic, none, averaged };

struct ElementBodySpec {
  ElementMesh mesh;
  ElementFormulation formulation = ElementFormulation::large_strain;
  ElementLocking locking = ElementLocking::automatic;
  double penalty = 0;  ///< κ of each cell's volume [Pa]
  double density = 0;  ///< [kg/m³]
  /// By the middle of an element and its number.
  std::function<PointMaterialSpec(const Vec3d&, int)> material;
  /// What muscle makes at an integration point, by its place and element, in the place of what the material says; none:
  /// as it says.
  std::function<std::shared_ptr<const ActiveStress>(const Vec3d&, int)> active{};
};

/// The groups of a mesh as a body has them.
std::vector<BodyGroup> body_groups(const ElementMesh& mesh);

/// Finite elements in a model: vertices with three degrees of freedom.
///
/// Mass is lumped: Σ ρ v N of linear elements, and in proportion to Σ ρ v N² of quadratic ones (Hinton, Rock and
/// Zienkiewicz 1976), whose Σ ρ v N is negative at corners of hexahedra; that is their weight in statics.
class ElementBody final : public ModelBody {
 public:
  /// Appends nodes to the model and elements to the builder.
  /// @throws InputError  a formulation that the elements cannot take
  ElementBody(ElementBodySpec spec, Model& model, PointSetBuilder& points);

  std::string model_name() const override;
  Attachment attach(const Vec3d& X) const override;
  Attachment attach_point(std::size_t point) const override;
  Attachment attach_surface(std::size_t point) const override;
  std::vector<Mat3d> gradients(const State& state) const override;
  PointTensors tensors_at(const Attachment& place, std::size_t nearest, const State& state) const override;
  TensorField tensor_field(const State& state) const override;
  std::vector<std::vector<int>> faces() const override;
  std::vector<FacePoint> face_points() const override;
  std::vector<char> nodes_on_boundary() const override { return on_boundary_; }
  double distance(const Vec3d& X) const override { return locator_.locate(X).distance; }
  std::string quality() const override { return quality_; }
  std::int64_t cell_number(int cell) const override { return mesh().element_number[static_cast<std::size_t>(cell)]; }

  Law law(int element) const;
  bool averaged() const { return averaged_; }

 private:
  void store_tensors(const State& state, ThreadPool& pool, std::span<PointTensors> out) const override;
  using PointGradients = std::array<Mat3d, kMostRulePoints>;
  struct Strained {
    double swelling = 0;  ///< relative change of the element's volume
    Mat3d turn;           ///< rotation of the element − I
  };
  /// What averages about nodes make of an element.
  struct Averaged {
    double pressure = 0;        ///< mean of λ θ [Pa]
    double energy_density = 0;  ///< of the volumetric strain [J/m³]
  };
  void number_nodes(Model& model);
  void choose_formulation(const ElementBodySpec& spec);
  void add_points(const ElementBodySpec& spec);
  void add_elements(const ElementBodySpec& spec, PointSetBuilder& points);
  void add_mass(const ElementBodySpec& spec, Model& model);
  void describe();
  Attachment attachment(std::size_t element, const ElementPoint& place) const;
  PointGradients gradients_in(std::size_t element, const State& state) const;
  Strained strained(std::size_t element, const PointGradients& gradients) const;
  std::vector<Averaged> averages(const State& state) const;
  PointTensors tensors_of(std::size_t point, const Mat3d& H, const RememberedStress& past, const Strained& element,
                          const std::optional<Averaged>& averaged) const;
  const ElementMesh& mesh() const { return locator_.mesh(); }

  ElementLocator locator_;
  ElementFormulation formulation_;
  std::vector<PointMaterialSpec> material_;  ///< of each element, while the body is built
  bool averaged_ = false;
  double penalty_ = 0;
  std::vector<char> on_boundary_;
  std::string quality_;
};

}  // namespace fascia
