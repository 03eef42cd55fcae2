// What a run should be told of its input, each matter once: a folder with the wrong names is one matter, not one a
// file.
#pragma once

#include <string>
#include <vector>

namespace nearpose::data_set {

struct Notice {
    std::string text;  // of the first time
    int first_frame = 0, last_frame = 0;
    int times = 0;
};

class Notices {
  public:
    // True where the matter is new. Numbers do not tell matters apart: "000001.png: is cut" and "000002.png: is cut"
    // are one.
    bool add(int frame_id, const std::string& text);
    const std::vector<Notice>& all() const { return notices_; }  // in the order in which they came

  private:
    std::vector<Notice> notices_;
};

// The text, and in how many frames more it is so.
std::string to_text(const Notice& notice);
// In how many frames more it is so, for a notice whose text has been said: "as in frame 0, ...". Empty for none.
std::string repeats_of(const Notice& notice);

}  // namespace nearpose::data_set
