// Words and numbers of a text file, without locale and without copies.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace nearpose {

class TextScanner {
  public:
    explicit TextScanner(std::string_view text) : text_(text) {}

    // Goes to the next line (ended by LF or CR LF); false at the end of the text.
    bool next_line() {
        if (next_ >= text_.size()) return false;
        const std::size_t end = text_.find('\n', next_);
        line_ = text_.substr(next_, end == std::string_view::npos ? end : end - next_);
        next_ = end == std::string_view::npos ? text_.size() : end + 1;
        ++line_number_;
        return true;
    }
    // The next word of the line; empty at its end.
    std::string_view word() {
        line_.remove_prefix(std::min(line_.find_first_not_of(kBlank), line_.size()));
        const std::string_view found = line_.substr(0, line_.find_first_of(kBlank));
        line_.remove_prefix(found.size());
        return found;
    }
    bool is_line_done() const { return line_.find_first_not_of(kBlank) == line_.npos; }
    std::int64_t line_number() const { return line_number_; }
    std::size_t position() const { return next_; }  // of the byte after the line

  private:
    static constexpr std::string_view kBlank = " \t\r\v\f";

    std::string_view text_;
    std::string_view line_;
    std::size_t next_ = 0;
    std::int64_t line_number_ = 0;
};

// The number that `word` is, as a whole. "nan" and "inf" are numbers here, and what is too large is infinite: it is for
// the caller to count and drop them.
inline std::optional<double> parse_real(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || end != word.data() + word.size()) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
        return tiny ? 0.0 : std::numeric_limits<double>::infinity();
    }
    if (error != std::errc()) return std::nullopt;
    return value;
}

inline std::optional<std::int64_t> parse_integer(std::string_view word) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (word.empty() || error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return value;
}

}  // namespace nearpose
