#include <cstring>
#include <stdexcept>

#include "raycast/mesh_files/gltf_guard.hpp"

namespace nearpose {
namespace {

constexpr std::string_view kGlbMagic = "glTF";
constexpr std::size_t kGlbHeaderBytes = 12;
constexpr std::size_t kChunkHeaderBytes = 8;

std::uint32_t number_at(std::string_view bytes, std::size_t position) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + position, sizeof(value));  // little endian, as the format is
    return value;
}

void append_number(std::string& bytes, std::size_t value) {
    const auto number = static_cast<std::uint32_t>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

}  // namespace

bool is_glb_file(std::string_view bytes) {
    return bytes.starts_with(kGlbMagic);
}

// A GLB is a header and chunks, the first of them JSON. Takes it apart and puts it together again with checked JSON.
std::string checked_glb(std::string_view bytes, const std::string& source, const std::filesystem::path& folder,
                        const MeshLimits& limits) {
    const auto fail = [&](const std::string& cause) { throw std::runtime_error(source + ": GLB: " + cause); };
    const std::size_t json_at = kGlbHeaderBytes + kChunkHeaderBytes;
    if (bytes.size() < json_at) fail("the file is cut short");
    if (number_at(bytes, 4) != 2) fail("the version is not 2");
    if (number_at(bytes, 8) != bytes.size()) fail("the file is cut short or longer than its header says");
    const std::size_t json_bytes = number_at(bytes, kGlbHeaderBytes);
    if (json_bytes > bytes.size() - json_at) fail("its JSON chunk is cut short");
    if (bytes.substr(kGlbHeaderBytes + 4, 4) != "JSON") fail("its first chunk is not JSON");

    std::string_view rest = bytes.substr(json_at + json_bytes);
    std::string_view binary;
    if (rest.size() >= kChunkHeaderBytes && rest.substr(4, 4) == std::string_view("BIN\0", 4)) {
        const std::size_t binary_bytes = number_at(rest, 0);
        if (binary_bytes > rest.size() - kChunkHeaderBytes) fail("its binary chunk is cut short");
        binary = rest.substr(kChunkHeaderBytes, binary_bytes);
    }
    std::string json = checked_gltf(bytes.substr(json_at, json_bytes), binary.size(), source, folder, limits);
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t padded_bytes = (binary.size() + 3) / 4 * 4;

    std::string glb(kGlbMagic);
    append_number(glb, 2);
    append_number(glb, json_at + json.size() + (binary.empty() ? 0 : kChunkHeaderBytes + padded_bytes));
    append_number(glb, json.size());
    glb += "JSON" + json;
    if (!binary.empty()) {
        append_number(glb, padded_bytes);
        glb.append("BIN\0", 4).append(binary).append(padded_bytes - binary.size(), '\0');
    }
    return glb;
}

}  // namespace nearpose
