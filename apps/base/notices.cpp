#include "apps/base/notices.hpp"

#include <algorithm>
#include <cstddef>

namespace nearpose::data_set {
namespace {

bool counts_as_digit(char c) {
    return c >= '0' && c <= '9';
}

// The end of the number that begins at `begin`: 12, 0.5, 1e-05. The point of "12.png" is none of it.
std::size_t number_end(const std::string& text, std::size_t begin) {
    std::size_t end = begin;
    const auto digit_at = [&](std::size_t at) { return at < text.size() && counts_as_digit(text[at]); };
    while (end < text.size()) {
        const bool signed_exponent = text[end] == 'e' && end + 1 < text.size() && text[end + 1] == '-';
        if (!counts_as_digit(text[end]) && !(text[end] == '.' && digit_at(end + 1)) && !signed_exponent) break;
        end += signed_exponent ? 2 : 1;
    }
    return end;
}

// The text with '#' for every number.
std::string matter_of(const std::string& text) {
    std::string matter;
    for (std::size_t i = 0; i < text.size();) {
        const bool number = counts_as_digit(text[i]);
        matter += number ? '#' : text[i];
        i = number ? number_end(text, i) : i + 1;
    }
    return matter;
}

std::string more_frames(const Notice& notice) {
    return std::to_string(notice.times - 1) + (notice.times == 2 ? " more frame" : " more frames") +
           " (the last: " + std::to_string(notice.last_frame) + ")";
}

}  // namespace

bool Notices::add(int frame_id, const std::string& text) {
    const std::string matter = matter_of(text);
    const auto same = [&](const Notice& notice) { return matter_of(notice.text) == matter; };
    const auto found = std::find_if(notices_.begin(), notices_.end(), same);
    if (found == notices_.end()) {
        notices_.push_back({text, frame_id, frame_id, 1});
        return true;
    }
    found->last_frame = frame_id;
    ++found->times;
    return false;
}

std::string to_text(const Notice& notice) {
    return notice.text + (notice.times > 1 ? "; the same in " + more_frames(notice) : "");
}

std::string repeats_of(const Notice& notice) {
    if (notice.times < 2) return {};
    return "as in frame " + std::to_string(notice.first_frame) + ", so in " + more_frames(notice);
}

}  // namespace nearpose::data_set
