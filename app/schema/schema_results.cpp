#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

std::vector<Choice> quantities() {
  return {
      {"displacement", "At points [m]."},
      {"position", "At points [m]."},
      {"rotation", "At points: the rotation vector [rad]."},
      {"velocity", "At points [m/s]."},
      {"strain", "At points: Green-Lagrange, 3 x 3 by rows."},
      {"stress", "At points: Cauchy, 3 x 3 by rows [Pa]."},
      {"force", "Of the constraint or load on the nodes in `where` [N]."},
      {"moment", "Likewise, about `about` [N m]."},
      {"volume",
       "Of the deformed material, of a body, of the nodes in `where` (what they move), or of the scene [m3]."},
      {"mass", "Of a body, of the nodes in `where`, or of the scene [kg]."},
      {"energy", "Elastic energy without stabilisation, likewise [J]."},
      {"kinetic_energy", "Of what moves [J]."},
      {"total_energy",
       "With stabilisation, kinetic energy and the potential of gravity, dead loads, fluids, and pressure on surfaces "
       "that are closed or held at their free edges [J]."},
      {"momentum", "Of what moves [kg m/s]."},
      {"angular_momentum", "About `about` [kg m2/s]."},
      {"max_displacement", "Of the matter of a body, or of the nodes in `where` [m]."},
      {"mean_displacement", "Likewise, by volume [m]."},
      {"frequency", "Of `solver.kind = \"modes\"` [1/s]."},
      {"fluid_volume", "What the fluid of a body fills [m3]."},
      {"fluid_pressure", "Of the fluid of a body, at the level of its centre at rest [Pa]."},
      {"contact_force", "What contact exerts on a body [N].", false},
      {"contact_area", "Of a body [m2].", false},
      {"minimum_gap", "Between bodies [m].", false}};
}

Shape probe_schema() {
  return table(
      {key("quantity", choice(quantities()), "What is measured.").needed(),
       key("body", text("the name of a body"), "The body; without it the whole scene, where that makes sense."),
       key("at", one_of({vector3("m"), array(vector3("m"), 1)}),
           "Material points by their rest position; a list of points gives a list of values."),
       key("where", reference("region", region_schema), "Nodes of the body."),
       key("about", vector3("m"), "Point that moments and angular momenta refer to.").defaults("[0, 0, 0]")});
}

std::vector<Choice> all_field_choices() {
  std::vector<Choice> all = field_choices();
  for (const Choice& field : shell_field_choices()) all.push_back(field);
  return all;
}

Shape picture_schema() {
  return table(
      {key("view", vector3("1"), "Direction from the body to the eye.").defaults("[1, 1, 1]"),
       key("size", array(integer(between(1, 16384)), 2, 2), "Width and height in pixels.").defaults("[1200, 800]"),
       key("field", choice(all_field_choices()), "Field that gives the colours.")
           .defaults("\"von_mises\"; of modes \"displacement\""),
       key("range", array(one_of({text("a quantity with a unit"), number("1")}), 2, 2),
           "Values of the first and the last colour, in the SI unit of the field or with a unit; not for "
           "`solver.kind = \"modes\"`.")
           .defaults("the values shown")});
}

}  // namespace

std::vector<Choice> field_choices() {
  return {{"displacement", "[m]"},
          {"rotation", "Rotation vector [rad]."},
          {"strain", "Green-Lagrange."},
          {"stress", "Cauchy [Pa]."},
          {"von_mises", "[Pa]; of a shell the larger of its faces'."},
          {"energy_density", "[J/m3]"}};
}

std::vector<Choice> shell_field_choices() {
  return {{"director", "Of a shell; with `to_outer_face`, half the thickness along it [m]."},
          {"thickness", "Of a shell, at rest [m]."},
          {"membrane_force", "Of a shell, a tensor [N/m]."},
          {"bending_moment", "Of a shell, a tensor [N]; positive where it stretches the outer face."},
          {"stress_outer", "Of a shell, on the face that the normals point to [Pa]."},
          {"stress_inner", "Of a shell, on the other face [Pa]."}};
}

Key probes_schema() {
  return key("probes", named_tables(probe_schema(), true), "What is measured. Names: letters, digits, _ and -.");
}

Key output_schema() {
  return key(
      "output",
      table({key("directory", text("a path"),
                 "Where the results go; relative to the directory that the program runs in, not to the scene file.")
                 .defaults("results/SCENE-NAME"),
             key("every", number("s", above(0)),
                 "Simulated time between saved states; not for `solver.kind = \"static\"`.")
                 .defaults("25 frames a simulated second; static: only the end"),
             key("every_steps", integer(between(1, 1e9)), "Steps between saved states."),
             key("fields", array(choice(all_field_choices())), "Fields in the files.").defaults("all"),
             key("format", choice({{"vtu", "VTK XML, with a .pvd."}}), "File format.").defaults("\"vtu\""),
             key("estimate",
                 one_of({boolean(), choice({{"finer", "By a finer mesh, however long that takes."},
                                            {"coarser", "By coarser meshes alone."}})}),
                 "Whether the errors of probes and displacements are estimated, by runs of the same scene at other "
                 "resolutions; `true`: by a finer mesh where it is small, else by coarser ones. See the manual's "
                 "chapter on probes.")
                 .defaults("false"),
             key("cache", one_of({boolean(), text("a path")}),
                 "Whether scattered frames and points are kept, and taken from there when the same geometry is sampled "
                 "again: the next run starts at once, with the same numbers. A path names the directory, relative to "
                 "that which the program runs in.")
                 .defaults("true: in the user's cache, `~/.cache/fascia/samples`"),
             later("checkpoint", "How often a run keeps what it needs to be resumed."),
             key("picture", picture_schema(), "A PNG of the end state; of modes, of each side by side.")
                 .defaults("none")},
            {{{"every", "every_steps"}, false}}),
      "What is written.");
}

}  // namespace fascia::app
