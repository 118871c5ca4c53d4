#include "io/gmsh/gmsh.hpp"

#include "core/base/errors.hpp"
#include "io/gmsh/gmsh_sections.hpp"
#include "io/mesh/text_numbers.hpp"

#include <cstddef>

namespace fascia::io {
namespace {

class GmshParser {
 public:
  GmshParser(std::string_view text, const std::string& name, MidNodes mid_nodes)
      : name_(name), text_(text), input_(text_.text, name), builder_(input_, mid_nodes) {}

  Mesh parse() {
    const std::string first(input_.word());
    if (first == "$NOD") {
      version_ = Version::one;
      read_section(first);
    } else if (first == "$MeshFormat") {
      input_.rest_of_line();
      read_format();
      end_section("$EndMeshFormat");
    } else {
      input_.fail(
          "is no Gmsh mesh: it must start with $MeshFormat (or $NOD, in version 1); save as .msh, version 2.2 "
          "or 4.1");
    }
    while (!input_.at_end()) read_section(std::string(input_.word()));
    if (!has_elements_)
      throw InputError(name_ + ": the mesh has no " + (version_ == Version::one ? "$ELM" : "$Elements") +
                       " section; the file is cut off or holds no mesh");
    Mesh mesh = builder_.finish(name_);
    text_.report(name_, mesh.messages);
    return mesh;
  }

 private:
  enum class Version { one, two, four };

  void read_format() {
    const std::string version(input_.word());
    const bool two = version == "2" || version == "2.0" || version == "2.1" || version == "2.2";
    if (!two && version != "4.1")
      input_.fail("version \"" + version.substr(0, 20) + "\" of Gmsh's format is not supported; save as 4.1 or 2.2 " +
                  "(gmsh -format msh41)");
    version_ = two ? Version::two : Version::four;
    const std::int64_t kind = input_.text_integer("the kind of file");
    if (kind != 0 && kind != 1) input_.fail("the kind of file is " + std::to_string(kind) + "; must be 0 (ASCII) or 1");
    const std::int64_t size = input_.text_integer("the size of a number");
    if (size != 8) input_.fail("numbers of " + std::to_string(size) + " bytes are not supported; must be 8");
    input_.rest_of_line();
    if (kind == 0) return;
    input_.set_binary(true);
    if (input_.int32("the mark of the byte order") != 1)
      input_.fail("the bytes are in the order of another kind of machine; save as ASCII");
  }

  void read_section(const std::string& section) {
    if (section.size() < 2 || section[0] != '$' || section.rfind("$End", 0) == 0 || section.rfind("$END", 0) == 0)
      input_.fail("expected a section ($...) and found something else; the section before it is longer than it says");
    input_.rest_of_line();
    if (section == "$PartitionedEntities") input_.fail("the mesh is partitioned; save it without partitions");
    const bool one = version_ == Version::one, four = version_ == Version::four;
    const std::string end = (one ? "$END" : "$End") + section.substr(1);
    if (section == "$PhysicalNames") {
      read_physical_names();
    } else if (section == "$Entities" && four) {
      if (has_elements_) input_.fail("$Entities must come before $Elements");
      entities_ = read_entities_41(input_, builder_);
    } else if (section == (one ? "$NOD" : "$Nodes")) {
      once(has_nodes_, section);
      four ? read_nodes_41(input_, builder_) : read_nodes_22(input_, builder_);
    } else if (section == (one ? "$ELM" : "$Elements")) {
      if (!has_nodes_) input_.fail(section + " must come after " + (one ? "$NOD" : "$Nodes"));
      once(has_elements_, section);
      read_elements();
    } else {
      input_.skip_past_line(end);
      return;
    }
    end_section(end);
  }

  void read_elements() {
    switch (version_) {
      case Version::one:
        return read_elements_1(input_, builder_);
      case Version::two:
        return read_elements_22(input_, builder_);
      case Version::four:
        return read_elements_41(input_, builder_, entities_);
    }
  }

  void once(bool& done, const std::string& section) {
    if (done) input_.fail("a second " + section + " section; a file holds one mesh");
    done = true;
  }

  void end_section(const std::string& end) {
    if (input_.word() != end)
      input_.fail("expected " + end + "; the section holds more than it says, or the file is cut off");
  }

  /// Text in binary files too: lines of dimension, number, "name".
  void read_physical_names() {
    const std::int64_t count = input_.text_integer("the number of names");
    if (count < 0) input_.fail("the number of names is " + std::to_string(count) + "; must not be negative");
    for (std::int64_t n = 0; n < count; ++n) {
      const std::int64_t dimension = input_.text_integer("the dimension of a physical group");
      if (dimension < 0 || dimension > 3)
        input_.fail("the dimension of a physical group is " + std::to_string(dimension) + "; must be 0 to 3");
      const std::int64_t number = input_.text_integer("the number of a physical group");
      const std::string_view line = input_.rest_of_line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open == std::string_view::npos || close == open)
        input_.fail("the name of physical group " + std::to_string(number) + " must stand in double quotes");
      builder_.name_group(static_cast<int>(dimension), number, std::string(line.substr(open + 1, close - open - 1)));
    }
  }

  std::string name_;
  BareText text_;
  GmshInput input_;
  GmshBuilder builder_;
  GmshEntities entities_;
  Version version_ = Version::two;
  bool has_nodes_ = false, has_elements_ = false;
};

}  // namespace

Mesh parse_gmsh(std::string_view text, const std::string& name, MidNodes mid_nodes) {
  return GmshParser(text, name, mid_nodes).parse();
}

}  // namespace fascia::io
