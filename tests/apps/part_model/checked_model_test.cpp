// What is said of a model when it is loaded, as a user sees it.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "apps/data_set/bop_models.hpp"
#include "tests/apps/support/tiny_scene.hpp"

namespace nearpose::program_tests {
namespace {

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

struct Obj {
    std::string text;
    int vertices = 0;

    void vertex(double x, double y, double z) {
        text += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
        ++vertices;
    }
    void face(std::initializer_list<int> corners, int first) {
        text += "f";
        for (const int corner : corners) text += " " + std::to_string(first + corner);
        text += "\n";
    }
    // A box with half sides of 30, 20 and 45 mm times `scale`.
    void box(double scale = 1.0) {
        const int first = vertices + 1;
        for (int i = 0; i < 8; ++i)
            vertex(scale * (i % 2 == 0 ? -30 : 30), scale * (i / 2 % 2 == 0 ? -20 : 20), scale * (i < 4 ? -45 : 45));
        face({0, 2, 3, 1}, first);
        face({4, 5, 7, 6}, first);
        face({0, 1, 5, 4}, first);
        face({2, 6, 7, 3}, first);
        face({0, 4, 6, 2}, first);
        face({1, 3, 7, 5}, first);
    }
    void floor() {
        const int first = vertices + 1;
        for (const double x : {-500.0, 500.0})
            for (const double y : {-500.0, 500.0}) vertex(x, y, -45.0);
        face({0, 1, 3, 2}, first);
    }
    void triangle_far_off() {
        const int first = vertices + 1;
        vertex(3030, 0, 0);
        vertex(3031, 0, 0);
        vertex(3030, 1, 0);
        face({0, 1, 2}, first);
    }
};

class CheckedModel : public testing::Test {
  protected:
    Outcome imported(const Obj& obj, const std::string& more = "") const {
        write_text(scene_.file("part.obj"), obj.text);
        return run_nearpose("import --model " + scene_.file("part.obj").string() + " --no-symmetries --out " +
                            scene_.file("imported").string() + more);
    }
    double diameter_mm() const { return 1e3 * data_set::read_model_info(scene_.file("imported"), 1).diameter_m; }

    TinyScene scene_{1};
    const double box_mm_ = 2.0 * std::sqrt(30.0 * 30.0 + 20.0 * 20.0 + 45.0 * 45.0);
};

TEST_F(CheckedModel, NothingIsSaidOfAGoodOne) {
    Obj obj;
    obj.box();
    const Outcome outcome = imported(obj);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_NEAR(diameter_mm(), box_mm_, 1e-3);
}

TEST_F(CheckedModel, StrayPiecesAreNamedAndLeftOutWhenAsked) {
    Obj stray, floor;
    stray.box();
    stray.triangle_far_off();
    floor.box();
    floor.floor();
    Outcome outcome = imported(stray);
    EXPECT_TRUE(contains(outcome.err, "part.obj: a piece of 1 triangle lies 3.00 m from the rest. It counts as a part"))
        << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "--keep-largest leaves it out")) << outcome.err;
    EXPECT_GT(diameter_mm(), 3000.0);
    outcome = imported(floor);
    EXPECT_TRUE(contains(outcome.err, "a flat piece of 2 triangles is 12.3 times as large as the rest")) << outcome.err;
    for (const Obj& obj : {stray, floor}) {
        outcome = imported(obj, " --keep-largest");
        EXPECT_EQ(outcome.exit_code, 0);
        EXPECT_TRUE(contains(outcome.err, ": left out")) << outcome.err;
        EXPECT_NEAR(diameter_mm(), box_mm_, 1e-3);
    }
    EXPECT_EQ(run_nearpose("import --tum a --camera b --out c/test/1 --keep-largest").exit_code, 2);
}

TEST_F(CheckedModel, MissingFacesAndInnerBodiesAreNamed) {
    Obj open, inner, twice;
    open.box();
    open.text.erase(open.text.rfind("f "));
    Outcome outcome = imported(open);
    EXPECT_TRUE(contains(outcome.err, "the surface has holes: 24 % of its edges")) << outcome.err;
    inner.box();
    inner.box(0.98);
    outcome = imported(inner);
    EXPECT_TRUE(contains(outcome.err, "% of the surface cannot be seen from outside, as of a second shell"))
        << outcome.err;
    twice.box();
    twice.box();
    outcome = imported(twice);
    EXPECT_TRUE(contains(outcome.err, "100 % of the edges belong to more than two triangles")) << outcome.err;
}

TEST_F(CheckedModel, EstimateSaysItToo) {
    Obj obj;
    obj.box();
    obj.triangle_far_off();
    write_text(scene_.file("part.obj"), obj.text);
    const Outcome outcome =
        run_nearpose("estimate --scene " + scene_.scene().string() + " --model " + scene_.file("part.obj").string() +
                     " --keep-largest --out " + scene_.file("poses.csv").string());
    EXPECT_TRUE(contains(outcome.err, "a piece of 1 triangle lies 3.00 m from the rest: left out")) << outcome.err;
}

}  // namespace
}  // namespace nearpose::program_tests
