#include "apps/tables/table_text.hpp"

#include <gtest/gtest.h>

namespace nearpose::tables {
namespace {

TEST(TableText, AlignsColumnsAndMarksWhatIsNotKnown) {
    Table table;
    table.title = "Title";
    table.text = "Text.";
    table.columns = {{"a", "mm", 1}, {"long title", "", 0}};
    table.rows = {{"first", 3, {{1.75, {}, {}}, {7.0, {}, {}}}}, {"2nd", 12, {{}, {123.0, {}, {}}}}};
    EXPECT_EQ(text_of(table),
              "Title\nText.\n\n"
              "       runs  a [mm]  long title\n"
              "first     3     1.8           7\n"
              "2nd      12       -         123\n");
}

}  // namespace
}  // namespace nearpose::tables
