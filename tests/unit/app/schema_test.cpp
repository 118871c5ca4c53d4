#include "app/schema/schema_export.hpp"
#include "tests/support/paths.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

namespace fascia::app::schema_test {
namespace {

std::string file_text(const std::string& name) {
  std::ifstream file(fascia::test::source_dir().string() + "/" + name);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

/// With FASCIA_UPDATE_REFERENCE in the environment the files are written anew.
void expect_up_to_date(const std::string& name, const std::string& text) {
  if (std::getenv("FASCIA_UPDATE_REFERENCE")) std::ofstream(fascia::test::source_dir().string() + "/" + name) << text;
  EXPECT_TRUE(file_text(name) == text) << name
                                       << " is not what the schema says; run this test with FASCIA_UPDATE_REFERENCE=1";
}

TEST(Schema, ReferencePageIsUpToDate) { expect_up_to_date("docs/scene-reference.md", schema_as_markdown()); }

TEST(Schema, JsonSchemaIsUpToDate) { expect_up_to_date("schemas/scene.schema.json", schema_as_json_schema()); }

}  // namespace
}  // namespace fascia::app::schema_test
