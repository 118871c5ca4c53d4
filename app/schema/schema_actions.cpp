#include "app/schema/schema.hpp"

namespace fascia::app {
namespace {

Shape axis_names() {
  return array(choice({{"x", "Position along the first axis."},
                       {"y", "Position along the second axis."},
                       {"z", "Position along the third axis."},
                       {"rx", "Rotation about the first axis."},
                       {"ry", "Rotation about the second axis."},
                       {"rz", "Rotation about the third axis."}}),
               1, 6);
}

Shape fix_schema() {
  return one_of({choice({{"all", "Positions and rotations."},
                         {"position", "Positions."},
                         {"rotation", "Rotations."},
                         {"symmetry", "A plane of symmetry with `normal`."},
                         {"hinge", "A hinge about `axis`: positions, and rotations across the axis."}}),
                 axis_names()});
}

Shape move_schema() {
  const Shape rotate = table({key("axis", vector3("1"), "Axis.").needed(),
                              key("angle", number("rad"), "Angle; may exceed a turn.").needed(),
                              key("center", vector3("m"), "Point of the axis.").defaults("[0, 0, 0]")});
  return table({key("translate", vector3("m"), "Displacement.").defaults("[0, 0, 0]"),
                key("rotate", rotate, "Rotation."),
                key("axes", axis_names(), "Axes that follow the motion; the others are free.").defaults("all six")});
}

Shape constraint_schema() {
  return table({key("body", text("the name of a body"), "The body.").needed(),
                key("where", region_reference(), "Its nodes.").needed(), key("fix", fix_schema(), "What is held."),
                key("driver", text("a name"),
                    "With `fix`. The name under which a program that embeds the library moves what is held at every "
                    "step; `fascia run` holds it where it is."),
                key("move", move_schema(), "What follows a motion, and stays where it ends."),
                key("axes", array(vector3("1"), 3, 3), "Three perpendicular directions instead of the global axes.")
                    .defaults("[[1, 0, 0], [0, 1, 0], [0, 0, 1]]"),
                key("normal", vector3("1"), "With `fix = \"symmetry\"`."),
                key("axis", vector3("1"), "With `fix = \"hinge\"`."), over_key(), profile_key(), dial_key(),
                later("from", "Time from which it holds."), later("until", "Time until which it holds.")},
               {{{"fix", "move"}}});
}

Shape load_schema() {
  return table(
      {key("body", text("the name of a body"), "The body.").needed(),
       key("where", region_reference(),
           "Its nodes, for `total_force`, `total_torque` and `force_per_node`; its faces, for `traction` and "
           "`pressure`; its edges, for `line_force`."),
       key("at", vector3("m"), "A material point by its rest position, for `force` and `torque`."),
       key("total_force", vector3("N"), "Shared by volume among what is selected."),
       key("total_torque", vector3("N m"), "Shared likewise."), key("force_per_node", vector3("N"), "On each node."),
       key("force", vector3("N"), "At the point."), key("torque", vector3("N m"), "At the point."),
       key("traction", vector3("Pa"),
           "Force per area of the undeformed surface, on the faces whose nodes `where` selects. Keeps its direction."),
       key("pressure", number("Pa"),
           "Against the outward normal of the faces whose nodes `where` selects; of an open surface, against the "
           "normal "
           "by the right-hand rule of its triangles."),
       key("line_force", vector3("N/m"),
           "Force per length of the undeformed edges whose ends `where` selects: the free edges of a surface, where it "
           "has any."),
       key("follower", boolean(), "Turns with the material; not for `traction`.")
           .defaults("false; true for `pressure`"),
       over_key(), profile_key(), dial_key(), later("from", "Time from which it acts."),
       later("until", "Time until which it acts.")},
      {{{"where", "at"}}});
}

Shape coupling_schema() {
  return table(
      {key("kind",
           choice({{"weld", "The nodes are fixed in the nearest frames of another body."},
                   {"embed", "The nodes are embedded in the field of another body."},
                   {"spring", "Springs run from the nodes to a point of space."}}),
           "What holds the nodes.")
           .needed(),
       key("body", text("the name of a body"), "The body whose nodes are held.").needed(),
       key("where", region_reference(), "Its nodes.").needed(),
       key("to", text("the name of a body"), "The other body; for `weld` and `embed`, which need it."),
       key("point", vector3("m"), "Where the springs end; for `spring`, which needs it."),
       key("stiffness", number("N/m", above(0)), "Of all the nodes' springs together; for `spring`, which needs it."),
       key("direction", vector3("1"), "The springs resist displacements along this direction alone; for `spring`.")
           .defaults("they resist a change of their length"),
       later("to_where", "Nodes of another body, to which springs run."),
       later("to_at", "A material point of another body, to which springs run."),
       later("slack", "Of springs: what they lengthen by before they pull."),
       later("tension_only", "Springs that do not push."), later("damping", "Of springs."),
       later("rest_length", "Of springs."), later("curve", "Stretches and forces of springs.")});
}

}  // namespace

Key constraints_schema() {
  return key("constraints", array(constraint_schema()), "What is held or moved, one `[[constraints]]` each.");
}
Key loads_schema() { return key("loads", array(load_schema()), "Forces and torques, one `[[loads]]` each."); }

Key couplings_schema() {
  return key("couplings", named_tables(coupling_schema(), true),
             "Welds and embeddings of bodies in others, and springs. Names: letters, digits, _ and -, not those of "
             "bodies.");
}

}  // namespace fascia::app
