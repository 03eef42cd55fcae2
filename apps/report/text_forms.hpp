// How data and names are put into a page.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace nearpose::report {

// RFC 4648, with padding.
std::string base64(std::span<const std::byte> bytes);
// The values' bytes as they lie in memory: the page reads them as little-endian.
template <typename Range>
std::string base64_of(const Range& values) {
    return base64(std::as_bytes(std::span(values)));
}

// Text between tags or in a quoted attribute.
std::string html_escaped(std::string_view text);
// JSON that may stand in a <script> element: no text in it can end the element or begin a comment.
std::string script_safe(std::string json);

}  // namespace nearpose::report
