#include "apps/data_set/log_jsonl.hpp"

#include <stdexcept>
#include <string>

namespace nearpose::data_set {

void JsonLinesWriter::append(std::string_view object) {
    const bool whole = object.size() >= 2 && object.front() == '{' && object.back() == '}';
    if (!whole || object.find_first_of("\r\n") != object.npos) {
        throw std::invalid_argument(file_.name() + ": a log row must be one JSON object without line breaks");
    }
    file_.append(std::string(object) + "\n");
}

}  // namespace nearpose::data_set
