#include "raycast/mesh_files/json_outline.hpp"

#include <stdexcept>
#include <utility>

#include "raycast/mesh_files/text_scanner.hpp"

namespace nearpose {
namespace {

class Parser {
  public:
    Parser(std::string_view text, std::string source, int max_depth, int max_values)
        : text_(text), source_(std::move(source)), max_depth_(max_depth), values_left_(max_values) {}

    JsonValue parse_all() {
        JsonValue value = parse_value(0);
        skip_blanks();
        if (position_ != text_.size()) fail("something follows the end of the JSON text");
        return value;
    }

  private:
    [[noreturn]] void fail(const std::string& cause) const {
        throw std::runtime_error(source_ + ": byte " + std::to_string(position_) + " of the JSON text: " + cause);
    }

    void skip_blanks() { position_ = std::min(text_.find_first_not_of(" \t\r\n", position_), text_.size()); }

    char peek() {
        skip_blanks();
        if (position_ == text_.size()) fail("the text is cut short");
        return text_[position_];
    }
    bool take(char wanted) {
        if (peek() != wanted) return false;
        ++position_;
        return true;
    }

    // Recursion is as deep as max_depth_, which is checked before it.
    JsonValue parse_value(int depth) {
        if (--values_left_ < 0) fail("too many values");
        const char first = peek();
        if (first == '{' || first == '[') {
            if (depth >= max_depth_) fail("nested deeper than " + std::to_string(max_depth_));
            return parse_container(depth, first == '{');
        }
        JsonValue value;
        if (first == '"') {
            value.kind = JsonValue::Kind::kString;
            value.text = parse_string();
            return value;
        }
        const std::size_t end = std::min(text_.find_first_of(" \t\r\n,]}", position_), text_.size());
        value.text = text_.substr(position_, end - position_);
        const bool literal = value.text == "true" || value.text == "false" || value.text == "null";
        value.kind = literal ? JsonValue::Kind::kLiteral : JsonValue::Kind::kNumber;
        const bool begins_as_number = first == '-' || (first >= '0' && first <= '9');
        if (!literal && !(begins_as_number && parse_real(value.text))) fail("not a JSON value");
        position_ = end;
        return value;
    }

    JsonValue parse_container(int depth, bool is_object) {
        JsonValue value;
        value.kind = is_object ? JsonValue::Kind::kObject : JsonValue::Kind::kArray;
        const char closing = is_object ? '}' : ']';
        const std::size_t first = position_++;
        if (!take(closing)) {
            do {
                if (is_object) {
                    if (peek() != '"') fail("a key is missing");
                    value.keys.push_back(parse_string());
                    if (!take(':')) fail("a colon is missing");
                }
                value.items.push_back(parse_value(depth + 1));
            } while (take(','));
            if (!take(closing)) fail("a comma or a closing bracket is missing");
        }
        value.text = text_.substr(first, position_ - first);
        return value;
    }

    std::string_view parse_string() {
        const std::size_t first = ++position_;
        for (; position_ < text_.size(); ++position_) {
            if (text_[position_] == '\\') {
                ++position_;
            } else if (text_[position_] == '"') {
                return text_.substr(first, position_++ - first);
            }
        }
        position_ = text_.size();
        fail("a string has no end");
    }

    std::string_view text_;
    std::string source_;
    std::size_t position_ = 0;
    int max_depth_;
    int values_left_;
};

}  // namespace

const JsonValue* JsonValue::find(std::string_view key) const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        if (keys[i] == key) return &items[i];
    }
    return nullptr;
}

std::optional<std::int64_t> JsonValue::as_count() const {
    if (kind != Kind::kNumber) return std::nullopt;
    const std::optional<std::int64_t> value = parse_integer(text);
    return value && *value >= 0 ? value : std::nullopt;
}

JsonValue parse_json_outline(std::string_view text, const std::string& source, int max_depth, int max_values) {
    return Parser(text, source, max_depth, max_values).parse_all();
}

}  // namespace nearpose
