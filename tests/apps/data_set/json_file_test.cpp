#include "apps/data_set/json_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

using namespace testing_files;

JsonFile parsed(const std::string& text) {
    return JsonFile::from_text(text, "a.json");
}

TEST(JsonFile, ReadsWhatIsThere) {
    const JsonFile file = parsed(R"({"10": {"x": [1, 2.5]}, "9": {"name": "nine"}})");
    const auto members = file.root().numbered_members();
    ASSERT_EQ(members.size(), 2U);
    EXPECT_EQ(members[0].first, 9);  // by number, not by text
    EXPECT_EQ(members[0].second.at("name").text(), "nine");
    EXPECT_EQ(members[1].second.at("x").numbers(2)[1], 2.5);
    EXPECT_FALSE(file.root().find("11"));
}

TEST(JsonFile, ErrorsNameFilePlaceAndKey) {
    const JsonFile file = parsed(R"({"3": {"K": [1, "two"], "id": 1.5, "big": 4294967297, "huge": 1e20, "s": "t"}})");
    const JsonValue frame = file.root().at("3");
    expect_error([&] { frame.at("cam_K"); }, {"a.json", "3", "cam_K"});
    expect_error([&] { frame.at("K").numbers(2); }, {"a.json", "3/K/1", "number"});
    expect_error([&] { frame.at("K").numbers(9); }, {"a.json", "3/K", "9 numbers"});
    for (const char* key : {"id", "big", "huge"}) {
        expect_error([&] { frame.at(key).integer(); }, {"a.json", std::string("3/") + key, "whole number"});
    }
    expect_error([&] { frame.at("s").number(); }, {"3/s", "number"});
    expect_error([&] { frame.at("s").at("x"); }, {"3/s", "object"});
    expect_error([&] { parsed("[1]").root().numbered_members(); }, {"a.json", "object"});
    expect_error([&] { parsed(R"({"one": 1})").root().numbered_members(); }, {"one", "number"});
    expect_error([&] { parsed(R"({"1": 1, "01": 1})").root().numbered_members(); }, {"twice"});
}

TEST(JsonFile, BrokenFilesAreRefusedWithThePlace) {
    expect_error([] { parsed(""); }, {"a.json", "not JSON"});
    expect_error([] { parsed(R"({"3": {"cam_K": [1, 2)"); }, {"a.json", "3/cam_K", "not JSON"});
    expect_error([] { parsed(R"({"3": {"x": 1e999}})"); }, {"a.json"});
    expect_error([] { parsed(R"({"3": {"x": 1, "y": 2, "x": 3}})"); }, {"3/x", "twice"});
    EXPECT_NO_THROW(parsed(R"({"3": {"x": 1}, "4": {"x": 1}})"));
}

TEST(JsonFile, NumbersThatJsonHasNoWordsForAreNoNumbers) {
    const JsonFile file = parsed(R"({"x": [NaN, -Infinity, inf, -nan], "NaN": "a \"NaN\" \\", "last": nan})");
    for (const JsonValue& value : file.root().at("x").elements()) {
        expect_error([&] { value.number(); }, {"a.json", "x/", "null or NaN"});
    }
    EXPECT_EQ(file.root().at("NaN").text(), "a \"NaN\" \\");
    expect_error([&] { file.root().at("last").number(); }, {"last", "null or NaN"});
}

TEST(JsonFile, NumbersMayBeTextAndRows) {
    const JsonFile file =
        parsed(R"({"x": ["1.5", 2, "-3e-1"], "rows": [[1, 2], ["3", 4]], "bad": ["1,5"], "s": "nan"})");
    EXPECT_EQ(file.root().at("x").numbers(3), (std::vector<double>{1.5, 2.0, -0.3}));
    EXPECT_EQ(file.root().at("rows").numbers(4), (std::vector<double>{1.0, 2.0, 3.0, 4.0}));
    expect_error([&] { file.root().at("rows").numbers(2); }, {"rows", "2 numbers"});
    expect_error([&] { file.root().at("bad").numbers(); }, {"bad/0", "number"});
    expect_error([&] { file.root().at("s").number(); }, {"s", "finite"});
}

TEST(JsonFile, ValuesAreCounted) {
    const std::string text(static_cast<std::size_t>(kMaxJsonValues), ',');
    expect_error([&] { parsed("[" + text + "]"); }, {"a.json", "more than 4000000 values"});
}

TEST(JsonFile, DepthIsLimited) {
    const auto nested = [](std::size_t depth) { return std::string(depth, '[') + std::string(depth, ']'); };
    EXPECT_NO_THROW(parsed(nested(kMaxJsonDepth)));
    expect_error([&] { parsed(nested(kMaxJsonDepth + 1)); }, {"a.json", "nests deeper"});
    expect_error([&] { parsed(std::string(10'000'000, '[')); }, {"a.json", "nests deeper"});
}

TEST(JsonFile, SizeIsLimitedBeforeReading) {
    const std::filesystem::path file = write_text(new_folder() / "huge.json", "{}");
    EXPECT_NO_THROW(JsonFile{file});
    std::filesystem::resize_file(file, kMaxJsonBytes + 1);  // a hole: nothing is on the disk
    expect_error([&] { JsonFile{file}; }, {"huge.json", "limit"});
    expect_error([&] { JsonFile{file.parent_path() / "none.json"}; }, {"none.json", "No such file"});
}

TEST(JsonFile, StringsAreEscaped) {
    EXPECT_EQ(json_string("a\"b\n"), R"("a\"b\n")");
    EXPECT_EQ(parsed("{\"x\": " + json_string("caf\xe9") + "}").root().at("x").text(), "caf\xef\xbf\xbd");
}

}  // namespace
}  // namespace nearpose::data_set
