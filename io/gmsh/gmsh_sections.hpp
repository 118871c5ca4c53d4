#pragma once

#include "io/gmsh/gmsh_builder.hpp"

#include <map>

/// The sections of a Gmsh file; each function starts behind the section's first line and stops before its last.
namespace fascia::io {

/// Physical groups of each geometric entity, by dimension and tag (4.1).
using GmshEntities = std::map<std::pair<int, std::int64_t>, std::vector<int>>;

void read_elements_1(GmshInput& input, GmshBuilder& builder);

/// Versions 1 and 2 write nodes alike.
void read_nodes_22(GmshInput& input, GmshBuilder& builder);
void read_elements_22(GmshInput& input, GmshBuilder& builder);

GmshEntities read_entities_41(GmshInput& input, GmshBuilder& builder);
void read_nodes_41(GmshInput& input, GmshBuilder& builder);
void read_elements_41(GmshInput& input, GmshBuilder& builder, const GmshEntities& entities);

}  // namespace fascia::io
