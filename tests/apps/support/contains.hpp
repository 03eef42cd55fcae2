// Whether a text holds another: what tests of messages and files ask.
#pragma once

#include <string>

namespace nearpose {

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace nearpose
