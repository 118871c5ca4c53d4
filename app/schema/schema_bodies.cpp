#include "app/scene/laws.hpp"
#include "app/schema/schema.hpp"

#include <fmt/format.h>

namespace fascia::app {
namespace {

Shape material() { return reference("material", material_schema); }

Shape thickness() {
  const Shape part =
      table({key("where", region_reference(), "Points or triangles that take this thickness.").defaults("\"all\""),
             key("value", number("m", above(0)), "The thickness.").needed()});
  return one_of({number("m", above(0)), array(part, 1)});
}

Shape initial_schema() {
  return table({key("velocity", vector3("m/s"), "Velocity of the point `about`.").defaults("[0, 0, 0]"),
                key("angular_velocity", vector3("rad/s"), "Angular velocity.").defaults("[0, 0, 0]"),
                key("about", vector3("m"), "Point that the rotation leaves where it is.").defaults("the mass centre")});
}

Shape fluid_schema() {
  return table({key("pressure", number("Pa"), "Pushes outward; kept whatever the volume."),
                key("bulk_modulus", number("Pa", above(0)),
                    "K of the pressure K (V* - V) / V*, where V is the enclosed volume."),
                key("volume", number("m3", above(0)),
                    "V* in the end; beside `bulk_modulus`. It grows from the rest volume over the schedule.")
                    .defaults("the rest volume"),
                key("density", number("kg/m3", at_least(0)), "Of its weight in `world.gravity`; it has no inertia.")
                    .defaults("0"),
                over_key(), profile_key(), dial_key()},
               {{{"pressure", "bulk_modulus"}}});
}

Shape transform_schema() {
  const Shape rotate = table(
      {key("axis", vector3("1"), "Axis through the origin.").needed(), key("angle", number("rad"), "Angle.").needed()});
  return table({key("translate", vector3("m"), "Added last.").defaults("[0, 0, 0]"),
                key("rotate", rotate, "Applied after `scale`."),
                key("scale", number("1", above(0)), "Factor about the origin, applied first.").defaults("1")});
}

Shape model_schema() {
  return choice({{"meshless", "Frames and integration points."},
                 {"tetrahedra", "Finite elements; 3 degrees of freedom a node."},
                 {"hexahedra", "Finite elements; 3 degrees of freedom a node."},
                 {"shell", "Triangles with thickness; 6 degrees of freedom a node."},
                 {"rigid", "One frame, of 6 degrees of freedom, that carries a surface: bone, instrument."},
                 {"surface",
                  "A surface without matter that rides on other bodies through couplings: for display, probes and "
                  "loads."}});
}

/// Keys of tetrahedra and hexahedra alone.
std::vector<Key> element_keys() {
  return {
      key("formulation",
          choice({{"st-venant-kirchhoff", "Large strain: the law of the material, whichever it is."},
                  {"corotational", "Small strain in axes that turn with the element."},
                  {"linear", "Small strain and small rotation."}}),
          "Strain of finite elements.")
          .defaults("\"st-venant-kirchhoff\""),
      key("order", integer(between(1, 2)), "Order of the shape functions of finite elements.").defaults("1"),
      key("incompressibility", number("Pa", at_least(0)),
          "Volume penalty of tetrahedra: kappa of the energy kappa V0 |s|^3 / 3, s = (V - V0) / V0 of each cell.")
          .defaults("0"),
      key("locking",
          choice({{"none", "No remedy."},
                  {"f-bar", "The volume change averaged over neighbouring cells; for `order = 1` and large strain."}}),
          "Remedy against volumetric locking of tetrahedra.")
          .defaults("chosen by Poisson's ratio; `fascia check` says which")};
}

Shape body_schema() {
  std::vector<Key> keys{
      key("model", model_schema(), "How the body is discretised.").needed(),
      key("domain", domain_schema(), "The space, surface or line that the body fills or carries.").needed(),
      key("mass", number("kg", above(0)),
          "Mass of the whole body. All but `model = \"surface\"` need it or `density`."),
      key("density", number("kg/m3", above(0)), "Mass of a volume; of a rigid body what its closed surface encloses."),
      key("material", body_material_schema(),
          "Name, inline table, or a list of which the first that selects a point or a cell's centre counts. Needed by "
          "all but `model = \"rigid\"` and `\"surface\"`."),
      key("frames", frames_schema(),
          "The frames of a meshless body, which needs them unless the scene states a `need`."),
      key("points", points_schema(), "The integration points of a meshless body."),
      key("weights", weights_schema(), "The weight functions of a meshless body."),
      key("initial", initial_schema(), "Motion at time 0."),
      key("transform", transform_schema(), "Moves the domain before anything is built."),
      key("thickness", thickness(),
          "Thickness of a shell, which needs it, or of a meshless sheet: of a rectangle, or of a file's triangles that "
          "bound no solid. A value, or a list of which the first that selects a point or a triangle's centre counts."),
      key("radius", number("m", above(0)), "Radius of a meshless line, or of a file's lines."),
      key("inertia", array(vector3("kg m2"), 3, 3),
          "Inertia of a rigid body about its mass centre, by rows, along the global axes after `transform`; beside "
          "`mass` or `density`.")
          .defaults("of the mass spread evenly over the volume, or over an open surface"),
      key("fluid", fluid_schema(), "What fills a closed body: its cavities, or all that its surface encloses."),
      body_need_key(),
      later("inertia_kind", "Lumped or consistent masses of elements.")};
  const std::vector<Key> elements = element_keys();
  keys.insert(keys.end(), elements.begin(), elements.end());
  return table(std::move(keys), {{{"mass", "density"}, false}}, "model");
}

}  // namespace

Shape body_material_schema() {
  const Shape part =
      table({key("where", region_reference(), "Points or cells that take this material.").defaults("\"all\""),
             key("use", one_of({text("the name of a material"), material()}), "Name of a material, or an inline table.")
                 .needed()});
  return one_of({text("the name of a material"), material(), array(part, 1)});
}

namespace {

/// With room for the rounding of degrees.
constexpr double kRightAngle = 1.5708;

/// Fibres, and the stress that they make by themselves.
void add_muscle_keys(std::vector<Key>& keys) {
  const Shape wound =
      table({key("point", vector3("m"), "On the axis.").defaults("[0, 0, 0]"),
             key("axis", vector3("1"), "Axis about which fibres wind.").needed(),
             key("angle", number("rad", between(-kRightAngle, kRightAngle)),
                 "From rings about the axis towards it, as a right-handed screw: \"90 deg\" runs along it.")
                 .defaults("0")});
  keys.push_back(
      key("fibres",
          array(table({key("direction", vector3("1"), "The same for all the material, at rest."),
                       key("cylindrical", wound, "Fibres that wind about an axis."),
                       later("cell_data", "A field of the mesh with their directions."),
                       later("laplace", "Regions between which they run."), later("k1", "Stiffness of the fibres."),
                       later("k2", "Of their exponent."), later("kappa", "Their dispersion.")},
                      {{{"direction", "cylindrical", "cell_data", "laplace"}}}),
                1),
          "Families of fibres, beside `active`."));
  keys.push_back(
      key("active",
          table({key("stress", number("Pa", above(0)), "Along the fibres at a factor of 1 (second Piola-Kirchhoff).")
                     .needed(),
                 key("direction", integer(at_least(0)), "Number of the family of fibres, from 0.").defaults("0"),
                 over_key(), profile_key(), dial_key()}),
          "Muscle: its fibres pull by themselves. Not for shells, nor with explicit steps."));
}

/// Young's modulus, Lamé's parameters or what a law has of its own.
Shape make_material_schema() {
  std::vector<Choice> laws;
  laws.reserve(kMaterialLaws.size());
  for (const LawWord& law : kMaterialLaws) laws.push_back({law.word, law.meaning});
  for (const char* law :
       {"ogden", "yeoh", "stable-neo-hookean", "transverse-isotropic", "orthotropic", "holzapfel-gasser-ogden"})
    laws.push_back({law, "", false});
  std::vector<Key> keys{key("law", choice(laws), "Elastic law.").defaults("\"st-venant-kirchhoff\""),
                        key("young", number("Pa", above(0)), "Young's modulus."),
                        key("poisson", number("1", inside(-1, 0.5)), "Poisson's ratio; goes with `young`."),
                        key("lame",
                            table({key("lambda", number("Pa"), "First parameter; 3 lambda + 2 mu > 0.").needed(),
                                   key("mu", number("Pa", above(0)), "Shear modulus.").needed()}),
                            "Lamé's parameters.")};
  Exclusive one{{"young", "lame"}};
  for (const LawWord& law : kMaterialLaws) {
    if (law.own.empty()) continue;
    one.keys.push_back(law.own.front().name);
    for (const LawKey& own : law.own) {
      const std::string of_law = fmt::format("With `law = \"{}\"`: {}", law.word, own.meaning);
      keys.push_back(own.needed ? key(own.name, number(own.unit), of_law)
                                : key(own.name, number(own.unit), of_law).defaults("0"));
    }
  }
  keys.push_back(
      key("bulk", number("Pa", above(0)), "Bulk modulus of laws with constants of their own, which need it."));
  keys.push_back(key("damping",
                     table({key("mass", number("1/s", at_least(0)), "On velocities.").defaults("0"),
                            key("stiffness", number("s", at_least(0)), "On the rate of strain.").defaults("0")}),
                     "Viscous damping."));
  keys.push_back(
      key("viscosity",
          array(table({key("share", number("1", inside(0, 1)), "Of the instantaneous stress.").needed(),
                       key("time", number("s", above(0)), "After which 1/e of the share is left.").needed()}),
                1),
          "Shares of the stress that fade (a Prony series): the constants of the law are the instantaneous "
          "ones, of which 1 minus the sum of the shares lasts."));
  keys.push_back(key("relax",
                     choice({{"all", "All of the stress."},
                             {"shear", "That of the shear modulus; the bulk modulus lasts. Not for thin bodies."}}),
                     "What fades, beside `viscosity`.")
                     .defaults("\"all\""));
  keys.push_back(
      key("statics",
          choice({{"long-term", "All that fades has done so."}, {"instantaneous", "Nothing has faded yet."}}),
          "How a static solve takes `viscosity`.")
          .defaults("\"long-term\""));
  add_muscle_keys(keys);
  keys.push_back(later("incompressible", "Of isochoric laws, in the place of `bulk`."));
  keys.push_back(later("axes", "Directions of orthotropy."));
  return table(std::move(keys), {one}, "law");
}

}  // namespace

const Shape& material_schema() {
  static const Shape material = make_material_schema();
  return material;
}

Key materials_schema() { return key("materials", named_tables(material(), false), "Materials, which bodies name."); }

Key bodies_schema() {
  return key("bodies", named_tables(body_schema(), true, 1), "What is simulated. Names: letters, digits, _ and -.")
      .needed();
}

}  // namespace fascia::app
