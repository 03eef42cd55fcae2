#include "apps/base/text_split.hpp"

namespace nearpose::data_set {

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    std::size_t begin = 0;
    for (std::size_t end = text.find(separator); end != text.npos; end = text.find(separator, begin)) {
        parts.push_back(text.substr(begin, end - begin));
        begin = end + 1;
    }
    parts.push_back(text.substr(begin));
    return parts;
}

std::vector<std::string_view> words(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    std::vector<std::string_view> parts;
    std::size_t begin = text.find_first_not_of(kBlank);
    while (begin != text.npos) {
        const std::size_t end = text.find_first_of(kBlank, begin);
        parts.push_back(text.substr(begin, end == text.npos ? text.npos : end - begin));
        begin = end == text.npos ? end : text.find_first_not_of(kBlank, end);
    }
    return parts;
}

std::vector<std::string_view> lines(std::string_view text) {
    if (text.empty()) return {};
    if (text.back() == '\n') text.remove_suffix(1);
    std::vector<std::string_view> result = split(text, '\n');
    for (std::string_view& line : result) {
        if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    }
    return result;
}

}  // namespace nearpose::data_set
