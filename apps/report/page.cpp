#include "apps/report/page.hpp"

#include <stdexcept>
#include <string_view>

#include "apps/report/text_forms.hpp"

// Defined by the assembler file that apps/viewer/viewer.cmake generates around the bundled viewer.
extern "C" {
extern const char nearpose_viewer_script_begin[];
extern const char nearpose_viewer_script_end[];
extern const char nearpose_viewer_style_begin[];
extern const char nearpose_viewer_style_end[];
extern const char nearpose_viewer_policy_begin[];
extern const char nearpose_viewer_policy_end[];
}

namespace nearpose::report {
namespace {

std::string_view between(const char* begin, const char* end) {
    return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

bool viewer_available() {
    return !between(nearpose_viewer_script_begin, nearpose_viewer_script_end).empty();
}

std::string page(const std::string& title, const std::string& json) {
    if (!viewer_available()) {
        throw std::runtime_error(
            "this program was built without the report: install nodejs and npm (Debian: apt-get install nodejs npm), "
            "have network for npm, configure and build again (cmake -DNEARPOSE_REPORT=ON says what is missing)");
    }
    std::string html =
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        // The page runs its own script alone and asks for nothing, whatever the names of files hold.
        "<meta http-equiv=\"Content-Security-Policy\" content=\"";
    html += between(nearpose_viewer_policy_begin, nearpose_viewer_policy_end);
    html +=
        "\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n"
        // An icon of no bytes: browsers ask the disk for one otherwise.
        "<link rel=\"icon\" href=\"data:,\">\n<title>";
    html += html_escaped(title);
    html += "</title>\n<style>";  // its hash and the script's are of all between the tags
    html += between(nearpose_viewer_style_begin, nearpose_viewer_style_end);
    html +=
        "</style>\n</head>\n<body>\n<noscript>This report needs JavaScript; it loads nothing.</noscript>\n"
        "<main id=\"page\"></main>\n<script type=\"application/json\" id=\"data\">";
    html += script_safe(json);
    html += "</script>\n<script>";
    html += between(nearpose_viewer_script_begin, nearpose_viewer_script_end);
    html += "</script>\n</body>\n</html>\n";
    return html;
}

}  // namespace nearpose::report
