// JSON files from outside: read with limits, and asked through getters whose errors name file, place and key.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace nearpose::data_set {

// A frame of scene_camera.json takes half a kilobyte. Some bytes make values of sixteen times their size.
inline constexpr std::uintmax_t kMaxJsonBytes = 32u << 20;
inline constexpr int kMaxJsonValues = 4'000'000;
inline constexpr int kMaxJsonDepth = 64;

// A value inside a JsonFile, which must outlive it. Every getter throws std::runtime_error naming the file, the place
// ("12/cam_K") and what was expected there.
class JsonValue {
  public:
    JsonValue(const nlohmann::json& value, const std::string& file, std::string place)
        : value_(&value), file_(&file), place_(std::move(place)) {}

    bool is_object() const;
    bool is_array() const;
    bool is_number() const;
    bool is_string() const;
    std::optional<JsonValue> find(const std::string& key) const;     // nullopt where this object lacks the key
    JsonValue at(const std::string& key) const;                      // throws where this object lacks the key
    std::vector<JsonValue> elements() const;                         // of an array
    std::vector<std::pair<std::string, JsonValue>> members() const;  // of an object, ordered by key
    // The members of an object whose keys are non-negative integers (BOP's frames and objects), in numeric order.
    std::vector<std::pair<int, JsonValue>> numbered_members() const;

    double number() const;                   // finite; also as a text: "0.1"
    int integer() const;                     // no fraction, fits an int
    std::uint64_t unsigned_integer() const;  // every one of 64 bits, as seeds are
    bool flag() const;                       // true or false
    std::string text() const;
    std::vector<double> numbers(std::size_t count) const;  // exactly `count` finite numbers, flat or in rows
    std::vector<double> numbers() const;                   // of any length, flat or in rows

    // The error to throw for a value that the caller refuses: "<file>: <place> <problem>".
    std::runtime_error error(const std::string& problem) const;

  private:
    const nlohmann::json* value_;
    const std::string* file_;
    std::string place_;
};

class JsonFile {
  public:
    // Throws std::runtime_error where the file cannot be read, is longer than kMaxJsonBytes, nests deeper than
    // kMaxJsonDepth, holds more than kMaxJsonValues, is no JSON, or has a key twice in one object. NaN and Infinity, as
    // Python writes them, are read as null.
    explicit JsonFile(const std::filesystem::path& path);
    // Text that came from elsewhere; `name` stands for the file in messages.
    static JsonFile from_text(const std::string& text, const std::string& name);
    ~JsonFile();
    JsonFile(JsonFile&&) noexcept;

    JsonValue root() const;

  private:
    struct Content;
    explicit JsonFile(std::unique_ptr<Content> content);
    std::unique_ptr<const Content> content_;
};

// A JSON string with its quotes, escaped; bytes that are not UTF-8 are replaced.
std::string json_string(const std::string& text);

}  // namespace nearpose::data_set
