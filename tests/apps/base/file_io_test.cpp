#include "apps/base/file_io.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "apps/base/number_text.hpp"
#include "apps/data_set/log_jsonl.hpp"
#include "tests/apps/support/test_files.hpp"

namespace nearpose::data_set {
namespace {

namespace fs = std::filesystem;
using namespace testing_files;

// Stands for a disk that fills up: files of this process can have so many bytes only.
class FileSizeLimit {
  public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

  private:
    rlimit before_{};
    void (*handler_)(int);
};

TEST(FileIo, AWholeFileComesBack) {
    const fs::path file = new_folder() / "a.bin";
    const std::string bytes("\0one\n\xff", 6);
    write_file_atomically(file, "older and longer");
    write_file_atomically(file, bytes);
    EXPECT_EQ(read_whole_file(file, 6), bytes);
    EXPECT_EQ(entries_of(file.parent_path()), 1U);
    expect_error([&] { read_whole_file(file, 5); }, {"a.bin", "6 bytes", "5"});
}

TEST(FileIo, WhatIsNoRegularFileIsNotRead) {
    const fs::path folder = new_folder();
    expect_error([&] { read_whole_file(folder / "none", 10); }, {"none", "No such file"});
    expect_error([&] { read_whole_file(folder, 10); }, {folder.string(), "not a regular file"});
    const fs::path pipe = folder / "pipe";  // without a writer a plain open would wait for ever
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    expect_error([&] { read_whole_file(pipe, 10); }, {"pipe", "not a regular file"});
}

TEST(FileIo, AFullDiskIsReportedAndTheOldFileStays) {
    expect_error([] { write_file_atomically("/dev/full", "x"); }, {"/dev/full", "No space left"});
    const fs::path file = new_folder() / "a.txt";
    write_file_atomically(file, "old");
    {
        const FileSizeLimit limit(10);
        expect_error([&] { write_file_atomically(file, std::string(20, 'x')); }, {"a.txt", "cannot be written"});
    }
    EXPECT_EQ(read_text(file), "old");
    EXPECT_EQ(entries_of(file.parent_path()), 1U);
}

TEST(FileIo, AnUnwritableOutputIsReported) {
    const fs::path folder = new_folder();
    expect_error([&] { write_file_atomically(folder / "none" / "a", "x"); }, {"none/a", "No such file"});
    expect_error([&] { write_file_atomically(folder, "x"); }, {folder.string(), "folder"});
    expect_error([&] { RowFile rows(folder / "none" / "a"); }, {"none/a", "cannot be opened"});
    write_text(folder / "file", "");
    expect_error([&] { create_folder(folder / "file" / "below"); }, {"file/below"});
}

TEST(FileIo, ADeviceIsNotReplacedByAFile) {
    write_file_atomically("/dev/null", "x");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));
}

TEST(FileIo, ALinkIsFollowed) {
    const fs::path folder = new_folder();
    write_text(folder / "target", "old");
    fs::create_symlink(folder / "target", folder / "link");
    write_file_atomically(folder / "link", "new");
    EXPECT_TRUE(fs::is_symlink(folder / "link"));
    EXPECT_EQ(read_text(folder / "target"), "new");
}

TEST(RowFile, RowsAreThereAsSoonAsTheyAreAppended) {
    const fs::path file = new_folder() / "rows";
    write_text(file, "of an earlier run");
    RowFile rows(file);
    rows.append("one\n");
    EXPECT_EQ(read_text(file), "one\n");
    rows.append("two\n");
    rows.close();
    EXPECT_EQ(read_text(file), "one\ntwo\n");
}

TEST(RowFile, AFullDiskLeavesWholeRows) {
    expect_error([] { RowFile("/dev/full").append("x\n"); }, {"/dev/full", "No space left"});
    const fs::path file = new_folder() / "rows";
    RowFile rows(file);
    {
        const FileSizeLimit limit(10);
        rows.append("123456\n");
        expect_error([&] { rows.append("123456\n"); }, {"rows", "cannot be written"});
    }
    EXPECT_EQ(read_text(file), "123456\n");
    rows.append("7\n");  // room again
    EXPECT_EQ(read_text(file), "123456\n7\n");
}

TEST(RowFile, AClosedPipeIsToldFromAnError) {
    int ends[2] = {-1, -1};
    ASSERT_EQ(::pipe(ends), 0);
    ::close(ends[0]);
    auto* const handler = std::signal(SIGPIPE, SIG_IGN);
    {
        RowFile rows("/proc/self/fd/" + std::to_string(ends[1]));
        EXPECT_THROW(rows.append("x\n"), ClosedPipe);
    }
    ::close(ends[1]);
    std::signal(SIGPIPE, handler);
}

TEST(JsonLines, OneObjectALine) {
    const fs::path file = new_folder() / "log.jsonl";
    JsonLinesWriter log(file);
    log.append("{\"format\": 1}");
    EXPECT_THROW(log.append("{\n}"), std::invalid_argument);
    EXPECT_THROW(log.append("[1]"), std::invalid_argument);
    log.append("{}");
    log.close();
    EXPECT_EQ(read_text(file), "{\"format\": 1}\n{}\n");
}

TEST(NumberText, NumbersComeBackBitForBit) {
    for (const double value : {0.1, -0.0, 1e-7, 1305031098.6659, 5e-324, 1.7976931348623157e308, 1.0 / 3.0}) {
        const std::optional<double> back = parse_number(format_number(value));
        ASSERT_TRUE(back);
        EXPECT_EQ(*back, value);
    }
    EXPECT_EQ(format_number(0.1), "0.1");
    EXPECT_EQ(format_fixed(1305031098.6659, 9).size(), 20U);
    EXPECT_EQ(format_fixed(0.0001, 3), "0.000");
    EXPECT_EQ(format_fixed(-0.0001, 3), "0.000");
    EXPECT_EQ(format_fixed(-0.5, 9), "-0.500000000");
    EXPECT_EQ(format_fixed(1e300, 9).size(), 311U);
}

TEST(NumberText, OnlyWholeNumbersAreParsed) {
    for (const char* text : {"", " 1", "1 ", "1,5", "1.5x", "0x10", "+1", "1e400"})
        EXPECT_FALSE(parse_number(text)) << text;
    for (const char* text : {"", "1.0", " 1", "1x", "99999999999999999999"}) EXPECT_FALSE(parse_integer(text)) << text;
    EXPECT_EQ(parse_integer("000042"), 42);
    EXPECT_EQ(zero_padded(42), "000042");
    EXPECT_EQ(zero_padded(1234567), "1234567");
}

TEST(NumberText, ADecimalCommaChangesNothing) {
    const CommaLocale locale;
    if (!locale.ok()) GTEST_SKIP() << "no locale with a decimal comma on this machine";
    EXPECT_EQ(format_number(0.9), "0.9");
    EXPECT_EQ(format_fixed(0.9, 3), "0.900");
    EXPECT_EQ(parse_number("0.9"), 0.9);
    EXPECT_EQ(format_number(1234567.5), "1234567.5");
}

}  // namespace
}  // namespace nearpose::data_set
