#include "apps/report/text_forms.hpp"

#include <bit>
#include <cstdint>

namespace nearpose::report {

static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

std::string base64(std::span<const std::byte> bytes) {
    constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
        std::uint32_t three = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            three = three << 8 | (j < count ? std::to_integer<std::uint32_t>(bytes[i + j]) : 0u);
        }
        for (std::size_t letter = 0; letter < 4; ++letter) {
            text += letter <= count ? kLetters[three >> (18 - 6 * letter) & 63u] : '=';
        }
    }
    return text;
}

std::string html_escaped(std::string_view text) {
    std::string escaped;
    for (const char letter : text) {
        switch (letter) {
            case '&':
                escaped += "&amp;";
                break;
            case '<':
                escaped += "&lt;";
                break;
            case '>':
                escaped += "&gt;";
                break;
            case '"':
                escaped += "&quot;";
                break;
            case '\'':
                escaped += "&#39;";
                break;
            default:
                escaped += letter;
        }
    }
    return escaped;
}

std::string script_safe(std::string json) {
    // '<' stands in JSON only within texts, where it may be written as an escape.
    std::string safe;
    safe.reserve(json.size());
    for (const char letter : json) {
        if (letter == '<') {
            safe += "\\u003c";
        } else {
            safe += letter;
        }
    }
    return safe;
}

}  // namespace nearpose::report
