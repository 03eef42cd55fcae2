#include "raycast/mesh_files/ply_header.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

constexpr std::size_t kMaxHeaderElements = 64;
constexpr std::size_t kMaxProperties = 256;  // of one element
constexpr std::size_t kMaxHeaderBytes = 1U << 20U;

std::optional<PlyType> parse_type(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, PlyType>, 16> kTypes{{{"char", PlyType::kInt8},
                                                                           {"int8", PlyType::kInt8},
                                                                           {"uchar", PlyType::kUint8},
                                                                           {"uint8", PlyType::kUint8},
                                                                           {"short", PlyType::kInt16},
                                                                           {"int16", PlyType::kInt16},
                                                                           {"ushort", PlyType::kUint16},
                                                                           {"uint16", PlyType::kUint16},
                                                                           {"int", PlyType::kInt32},
                                                                           {"int32", PlyType::kInt32},
                                                                           {"uint", PlyType::kUint32},
                                                                           {"uint32", PlyType::kUint32},
                                                                           {"float", PlyType::kFloat},
                                                                           {"float32", PlyType::kFloat},
                                                                           {"double", PlyType::kDouble},
                                                                           {"float64", PlyType::kDouble}}};
    for (const auto& [name, type] : kTypes) {
        if (name == word) return type;
    }
    return std::nullopt;
}

class HeaderParser {
  public:
    HeaderParser(std::string_view bytes, std::string source) : scanner_(bytes), source_(std::move(source)) {}

    PlyHeader parse() {
        if (!scanner_.next_line() || scanner_.word() != "ply") fail("the file does not begin with the line \"ply\"");
        while (scanner_.next_line() && scanner_.position() < kMaxHeaderBytes) {
            const std::string_view keyword = scanner_.word();
            if (keyword.empty() || keyword == "comment" || keyword == "obj_info") continue;
            if (keyword == "end_header") return finish();
            if (keyword == "format") {
                parse_format();
            } else if (keyword == "element") {
                parse_element();
            } else if (keyword == "property") {
                parse_property();
            } else {
                fail("unknown keyword \"" + std::string(keyword.substr(0, 40)) + "\" in the header");
            }
            if (!scanner_.word().empty()) fail("more words than this line of the header may have");
        }
        fail("the header has no line \"end_header\": the file is cut short or not a PLY file");
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": line " + std::to_string(scanner_.line_number()) + ": " + cause);
    }

    void parse_format() {
        if (has_format_) fail("a second format");
        has_format_ = true;
        const std::string_view name = scanner_.word();
        if (name == "ascii") {
            header_.format = PlyFormat::kText;
        } else if (name == "binary_little_endian") {
            header_.format = PlyFormat::kLittleEndian;
        } else if (name == "binary_big_endian") {
            header_.format = PlyFormat::kBigEndian;
        } else {
            fail("unknown format \"" + std::string(name.substr(0, 40)) + "\"");
        }
        if (scanner_.word() != "1.0") fail("the version of the format is not 1.0");
    }

    void parse_element() {
        PlyElement element;
        element.name = std::string(scanner_.word());
        const std::optional<std::int64_t> count = parse_integer(scanner_.word());
        if (element.name.empty() || !count || *count < 0) fail("an element needs a name and a count of 0 or more");
        element.count = static_cast<std::uint64_t>(*count);
        for (const PlyElement& other : header_.elements) {
            if (other.name == element.name) fail("element \"" + element.name + "\" for the second time");
        }
        header_.elements.push_back(std::move(element));
        if (header_.elements.size() > kMaxHeaderElements) fail("too many elements");
    }

    void parse_property() {
        if (header_.elements.empty()) fail("a property before the first element");
        PlyElement& element = header_.elements.back();
        PlyProperty property;
        std::string_view word = scanner_.word();
        if (word == "list") {
            property.is_list = true;
            property.count_type = require_type(scanner_.word());
            if (property.count_type == PlyType::kFloat || property.count_type == PlyType::kDouble) {
                fail("the length of a list must be of an integer type");
            }
            word = scanner_.word();
        }
        property.type = require_type(word);
        property.name = std::string(scanner_.word());
        if (property.name.empty()) fail("a property without a name");
        if (element.find(property.name) >= 0) fail("property \"" + property.name + "\" for the second time");
        element.properties.push_back(std::move(property));
        if (element.properties.size() > kMaxProperties) fail("too many properties");
    }

    PlyType require_type(std::string_view word) const {
        const std::optional<PlyType> type = parse_type(word);
        if (!type) fail("unknown type \"" + std::string(word.substr(0, 40)) + "\"");
        return *type;
    }

    PlyHeader finish() {
        if (!has_format_) fail("the header has no line \"format\"");
        for (const PlyElement& element : header_.elements) {
            if (element.count > 0 && element.properties.empty())
                fail("element \"" + element.name + "\" has no property");
        }
        header_.size = scanner_.position();
        header_.num_lines = scanner_.line_number();
        return std::move(header_);
    }

    TextScanner scanner_;
    std::string source_;
    PlyHeader header_;
    bool has_format_ = false;
};

}  // namespace

std::size_t size_of(PlyType type) {
    switch (type) {
        case PlyType::kInt8:
        case PlyType::kUint8:
            return 1;
        case PlyType::kInt16:
        case PlyType::kUint16:
            return 2;
        case PlyType::kInt32:
        case PlyType::kUint32:
        case PlyType::kFloat:
            return 4;
        case PlyType::kDouble:
            return 8;
    }
    return 8;
}

int PlyElement::find(std::string_view property) const {
    const auto found = std::find_if(properties.begin(), properties.end(),
                                    [&](const PlyProperty& candidate) { return candidate.name == property; });
    return found == properties.end() ? -1 : static_cast<int>(found - properties.begin());
}

PlyHeader parse_ply_header(std::string_view bytes, const std::string& source) {
    return HeaderParser(bytes, source).parse();
}

}  // namespace nearpose
