#include "apps/data_set/json_file.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <string_view>

#include "apps/base/file_io.hpp"
#include "apps/base/number_text.hpp"

namespace nearpose::data_set {

struct JsonFile::Content {
    std::string file;
    nlohmann::json root;
};

namespace {

// Follows the parser, so that depth and repeated keys are refused while reading, and an error can say where it is.
class Watcher {
  public:
    bool operator()(int depth, nlohmann::json::parse_event_t event, nlohmann::json& value) {
        using Event = nlohmann::json::parse_event_t;
        if (event == Event::object_start || event == Event::array_start) {
            if (depth >= kMaxJsonDepth) {
                throw std::runtime_error("nests deeper than " + std::to_string(kMaxJsonDepth) + " levels");
            }
            if (event == Event::object_start) objects_.emplace_back();
        } else if (event == Event::object_end) {
            objects_.pop_back();
        } else if (event == Event::key) {
            Object& object = objects_.back();
            object.key = value.get_ref<const std::string&>();
            if (!object.seen.insert(object.key).second) throw std::runtime_error("the key stands twice in one object");
        }
        return true;
    }

    // The keys down to where the parser is: "12/cam_K".
    std::string place() const {
        std::string text;
        for (const Object& object : objects_) text += (text.empty() ? "" : "/") + object.key;
        return text;
    }

  private:
    struct Object {
        std::set<std::string> seen;
        std::string key;
    };
    std::vector<Object> objects_;
};

std::string with_place(const std::string& name, const std::string& place, const std::string& problem) {
    return name + ": " + (place.empty() ? "" : place + ": ") + problem;
}

// Without the library's own number of the error: "[json.exception.parse_error.101] ".
std::string cause_of(const nlohmann::json::exception& error) {
    const std::string text = error.what();
    const std::size_t end = text.find("] ");
    return text.front() == '[' && end != text.npos ? text.substr(end + 2) : text;
}

// The text with null for numbers that JSON has no words for, as Python and C++ write them: NaN, -Infinity, inf.
std::string with_nulls(const std::string& text) {
    static const std::set<std::string_view> kNoNumbers = {"NaN", "nan", "Infinity", "inf", "Inf"};
    std::string result;
    result.reserve(text.size());
    bool in_string = false;
    for (std::size_t i = 0; i < text.size();) {
        const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
        std::size_t end = i + 1;
        if (in_string && text[i] == '\\') {
            end = std::min(end + 1, text.size());
        } else if (text[i] == '"') {
            in_string = !in_string;
        } else if (!in_string && is_letter(text[i])) {
            while (end < text.size() && is_letter(text[end])) ++end;
        }
        const std::string_view part = std::string_view(text).substr(i, end - i);
        const bool no_number = !in_string && kNoNumbers.contains(part);
        if (no_number && !result.empty() && result.back() == '-') result.pop_back();
        result += no_number ? "null" : part;
        i = end;
    }
    return result;
}

nlohmann::json parse(const std::string& text, const std::string& name) {
    if (text.size() > kMaxJsonBytes) throw std::runtime_error(name + ": longer than any JSON file that is read");
    // Commas part values. Memory and time go with them, so they are counted before anything is made of them.
    if (std::count(text.begin(), text.end(), ',') >= kMaxJsonValues) {
        throw std::runtime_error(name + ": holds more than " + std::to_string(kMaxJsonValues) + " values");
    }
    Watcher watcher;
    try {
        return nlohmann::json::parse(with_nulls(text), std::ref(watcher));
    } catch (const nlohmann::json::exception& error) {
        throw std::runtime_error(with_place(name, watcher.place(), "is not JSON: " + cause_of(error)));
    } catch (const std::runtime_error& error) {
        throw std::runtime_error(with_place(name, watcher.place(), error.what()));
    }
}

std::string joined(const std::string& place, const std::string& key) {
    return place.empty() ? key : place + "/" + key;
}

}  // namespace

bool JsonValue::is_object() const {
    return value_->is_object();
}
bool JsonValue::is_array() const {
    return value_->is_array();
}
bool JsonValue::is_number() const {
    return value_->is_number();
}
bool JsonValue::is_string() const {
    return value_->is_string();
}

std::runtime_error JsonValue::error(const std::string& problem) const {
    return std::runtime_error(with_place(*file_, place_, problem));
}

std::optional<JsonValue> JsonValue::find(const std::string& key) const {
    if (!is_object()) throw error("must be an object");
    const auto found = value_->find(key);
    if (found == value_->end()) return std::nullopt;
    return JsonValue(*found, *file_, joined(place_, key));
}

JsonValue JsonValue::at(const std::string& key) const {
    const std::optional<JsonValue> found = find(key);
    if (!found) throw error("lacks the key \"" + key + "\"");
    return *found;
}

std::vector<JsonValue> JsonValue::elements() const {
    if (!is_array()) throw error("must be an array");
    std::vector<JsonValue> result;
    result.reserve(value_->size());
    for (std::size_t i = 0; i < value_->size(); ++i) {
        result.emplace_back(value_->at(i), *file_, joined(place_, std::to_string(i)));
    }
    return result;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
    if (!is_object()) throw error("must be an object");
    std::vector<std::pair<std::string, JsonValue>> result;
    for (auto member = value_->begin(); member != value_->end(); ++member) {
        result.emplace_back(member.key(), JsonValue(member.value(), *file_, joined(place_, member.key())));
    }
    return result;
}

std::vector<std::pair<int, JsonValue>> JsonValue::numbered_members() const {
    std::vector<std::pair<int, JsonValue>> result;
    for (const auto& [key, value] : members()) {
        const std::optional<std::int64_t> number = parse_integer(key);
        if (!number || *number < 0 || *number > std::numeric_limits<int>::max()) {
            throw value.error("the key must be a number from 0 on");
        }
        result.emplace_back(static_cast<int>(*number), value);
    }
    const auto by_number = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::stable_sort(result.begin(), result.end(), by_number);
    for (std::size_t i = 1; i < result.size(); ++i) {
        if (result[i].first == result[i - 1].first)
            throw result[i].second.error("this number stands twice in the file");
    }
    return result;
}

double JsonValue::number() const {
    const auto text = is_string() ? parse_number(value_->get_ref<const std::string&>()) : std::nullopt;
    if (value_->is_null()) throw error("is null or NaN, but must be a number");
    if (!is_number() && !text) throw error("must be a number");
    const double value = text ? *text : value_->get<double>();
    if (!std::isfinite(value)) throw error("must be a finite number");
    return value;
}

int JsonValue::integer() const {
    // Through double, which holds every int exactly: the library's own conversion wraps 4294967297 to 1.
    const double value = number();
    if (value != std::floor(value) || std::abs(value) > std::numeric_limits<int>::max()) {
        throw error("is " + format_number(value) + ", but must be a whole number");
    }
    return static_cast<int>(value);
}

std::uint64_t JsonValue::unsigned_integer() const {
    if (!value_->is_number_unsigned()) throw error("must be a whole number from 0 on");
    return value_->get<std::uint64_t>();
}

bool JsonValue::flag() const {
    if (!value_->is_boolean()) throw error("must be true or false");
    return value_->get<bool>();
}

std::string JsonValue::text() const {
    if (!is_string()) throw error("must be a text");
    return value_->get<std::string>();
}

std::vector<double> JsonValue::numbers(std::size_t count) const {
    std::size_t here = is_array() ? value_->size() : 0;
    for (std::size_t i = 0; is_array() && i < value_->size(); ++i) {
        if (value_->at(i).is_array()) here += value_->at(i).size() - 1;
    }
    if (!is_array() || here != count) throw error("must be an array of " + std::to_string(count) + " numbers");
    return numbers();
}

std::vector<double> JsonValue::numbers() const {
    std::vector<double> result;
    for (const JsonValue& element : elements()) {
        const std::vector<JsonValue> row = element.is_array() ? element.elements() : std::vector{element};
        for (const JsonValue& value : row) result.push_back(value.number());
    }
    return result;
}

JsonFile::JsonFile(std::unique_ptr<Content> content) : content_(std::move(content)) {}

JsonFile JsonFile::from_text(const std::string& text, const std::string& name) {
    auto content = std::make_unique<Content>();
    content->file = name;
    content->root = parse(text, name);
    return JsonFile(std::move(content));
}

JsonFile::JsonFile(const std::filesystem::path& path)
    : JsonFile(from_text(read_whole_file(path, kMaxJsonBytes), path.string())) {}

JsonFile::~JsonFile() = default;
JsonFile::JsonFile(JsonFile&&) noexcept = default;

JsonValue JsonFile::root() const {
    return {content_->root, content_->file, ""};
}

std::string json_string(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace nearpose::data_set
