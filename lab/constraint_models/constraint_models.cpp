#include "lab/constraint_models/constraint_models.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lab/constraint_models/judge.hpp"
#include "lab/constraint_models/models.hpp"
#include "lab/constraint_models/scenes.hpp"
#include "lab/trial/random.hpp"

namespace thimble::lab {
namespace {

constexpr double kSpeed_m_s = 0.1;
constexpr double kTick_s = 0.001;
constexpr int kRestTicks = 50;  // at the end of each stage
constexpr double kRad_per_degree = std::numbers::pi / 180;
constexpr int kRandomCorners = 60;
constexpr int kJumps = 200;

double mm(double m) { return 1000 * m; }

// All of an experiment, model by model as scene by scene it is played.
class FigurePlayer {
 public:
  FigurePlayer() {
    findings_.experiment = "constraint-models";
    findings_.title = "What holds a hand: the thesis's figures 3-7 to 3-10";
    stages_ = {"stages",
               "Planes that hold at the figures' stages, and the proxy beside the hand",
               {{"scene", "", 0},
                {"stage", "", 0},
                {"model", "", 0},
                {"planes", "", 0},
                {"in_figure", "", 0},
                {"hand_x", "mm", 2},
                {"hand_y", "mm", 2},
                {"proxy_x", "mm", 2},
                {"proxy_y", "mm", 2}},
               {}};
    ways_ = {"ways",
             "All steps: none may be counted in the columns from proxy_outside to in_matter",
             {{"scene", "", 0},
              {"model", "", 0},
              {"steps", "", 0},
              {"most_planes", "", 0},
              {"proxy_outside", "", 0},
              {"pulling", "", 0},
              {"untouched", "", 0},
              {"in_matter", "", 0},
              {"deepest", "mm", 4},
              {"proxy_to_ghost", "mm", 4}},
             {}};
  }

  [[nodiscard]] Result<void> play(const Scene& scene) {
    auto models = make_models(scene);
    if (!models) return tl::unexpected(models.error());
    const std::vector<world::PlacedShape> matter(scene.matter.begin(), scene.matter.end());
    Table trace{"trace-" + scene.name,
                scene.title,
                {{"t", "s", 3}, {"hand_x", "mm", 3}, {"hand_y", "mm", 3}},
                {}};
    Plot plot{scene.name, scene.title, {"x [mm]", false}, {"y [mm]", false}, {}};
    for (const Outline& outline : scene.outlines) add_outline(outline, plot);
    add_hand(scene, trace, plot);
    for (const Model& model : *models) {
      for (const char* what : {"_proxy_x", "_proxy_y"})
        trace.columns.push_back({model.name + what, "mm", 3});
      trace.columns.push_back({model.name + "_planes", "", 0});
      follow(scene, model, matter, trace, plot);
    }
    trace.is_for_files = true;
    findings_.tables.push_back(std::move(trace));
    findings_.plots.push_back(std::move(plot));
    return {};
  }

  // A hand that jumps about a corner of any angle, in shapes and in their field.
  [[nodiscard]] Result<void> play_random(std::uint64_t seed) {
    Random random(seed);
    std::map<std::string, Verdict> verdicts;
    for (int i = 0; i < kRandomCorners; ++i) {
      const Scene scene = corner_scene("random", "", random.uniform(20, 160) * kRad_per_degree);
      auto models = make_models(scene);
      if (!models) return tl::unexpected(models.error());
      const std::vector<world::PlacedShape> matter(scene.matter.begin(), scene.matter.end());
      for (int jump = 0; jump < kJumps; ++jump) {
        const Position3 hand{random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02),
                             random.uniform(-0.002, 0.002)};
        for (const Model& model : *models) {
          judge(model, matter, hold(model, hand), verdicts[model.name]);
        }
      }
    }
    for (const auto& [name, verdict] : verdicts) add_way("random", name, verdict);
    return {};
  }

  [[nodiscard]] Findings finish(std::uint64_t seed) && {
    findings_.parameters = {{"seed", "", static_cast<double>(seed)},
                            {"speed", "m/s", kSpeed_m_s},
                            {"rate", "Hz", 1 / kTick_s},
                            {"cell", "mm", mm(kCell_m)},
                            {"random_corners", "", double{kRandomCorners}},
                            {"jumps_each", "", double{kJumps}}};
    findings_.criteria = {
        {"every proxy is where its planes allow", is_admissible_},
        {"no plane pulls, and none pushes that is not touched", is_complementary_},
        {"no ghost is in matter, in a field by its interpolation", is_free_},
        {"planes hold where the figures draw them, of cells as many; of the simple model those, "
         "too, that it should have let go",
         is_as_drawn_}};
    findings_.tables.insert(findings_.tables.begin(), {std::move(stages_), std::move(ways_)});
    return std::move(findings_);
  }

 private:
  static void add_outline(const Outline& outline, Plot& plot) {
    Series series{plot.series.empty() ? "matter" : "", Mark::Line, {}};
    for (const auto& [x_m, y_m] : outline) series.points.emplace_back(mm(x_m), mm(y_m));
    plot.series.push_back(std::move(series));
  }

  // All places of the hand, and at which of them a stage ends.
  struct Way {
    std::vector<Position3> hands;
    std::vector<std::size_t> ends;
  };
  static Way way_of(const Scene& scene) {
    Way way;
    Position3 from = scene.start;
    for (const FigureStage& stage : scene.stages) {
      const Displacement3 leg = stage.hand - from;
      const int ticks = static_cast<int>(std::ceil(norm(leg) / (kSpeed_m_s * kTick_s)));
      for (int i = 1; i <= ticks; ++i) way.hands.push_back(from + (double{1} * i / ticks) * leg);
      way.hands.insert(way.hands.end(), kRestTicks, stage.hand);
      way.ends.push_back(way.hands.size() - 1);
      from = stage.hand;
    }
    return way;
  }
  static void add_hand(const Scene& scene, Table& trace, Plot& plot) {
    Series series{"hand", Mark::Line, {}};
    for (const Position3& hand : way_of(scene).hands) {
      trace.rows.push_back(
          {static_cast<double>(trace.rows.size()) * kTick_s, mm(hand.x), mm(hand.y)});
      series.points.emplace_back(mm(hand.x), mm(hand.y));
    }
    plot.series.push_back(std::move(series));
  }

  void follow(const Scene& scene, const Model& model, const std::vector<world::PlacedShape>& matter,
              Table& trace, Plot& plot) {
    const Way way = way_of(scene);
    Series series{"proxy, " + model.name, Mark::Line, {}};
    Verdict verdict;
    std::size_t stage = 0;
    for (std::size_t i = 0; i < way.hands.size(); ++i) {
      const HeldHand held = hold(model, way.hands[i]);
      judge(model, matter, held, verdict);
      const auto planes = static_cast<double>(held.planes.size());
      trace.rows[i].insert(trace.rows[i].end(), {mm(held.proxy.x), mm(held.proxy.y), planes});
      series.points.emplace_back(mm(held.proxy.x), mm(held.proxy.y));
      if (stage < way.ends.size() && i == way.ends[stage])
        add_stage(scene, scene.stages[stage++], model, held);
    }
    plot.series.push_back(std::move(series));
    add_way(scene.name, model.name, verdict);
  }

  void add_stage(const Scene& scene, const FigureStage& stage, const Model& model,
                 const HeldHand& held) {
    const int drawn = model.has_ghost ? stage.planes : stage.simple_planes;
    const auto planes = static_cast<int>(held.planes.size());
    // Where cells meet at a point, shapes may hold by one plane across it, and so does a field.
    const bool counts = !model.has_ghost || model.name == "cells";
    const bool is_as_drawn = counts ? planes == drawn : (planes > 0) == (drawn > 0);
    is_as_drawn_ = is_as_drawn_ && is_as_drawn;
    stages_.rows.push_back({scene.name, stage.name, model.name, double{1} * planes,
                            double{1} * drawn, mm(held.hand.x), mm(held.hand.y), mm(held.proxy.x),
                            mm(held.proxy.y)});
  }

  void add_way(const std::string& scene, const std::string& model, const Verdict& verdict) {
    const auto number = [](std::size_t count) { return static_cast<double>(count); };
    is_admissible_ = is_admissible_ && verdict.is_admissible();
    is_complementary_ = is_complementary_ && verdict.is_complementary();
    is_free_ = is_free_ && verdict.in_matter == 0;
    ways_.rows.push_back({scene, model, number(verdict.steps), number(verdict.most_planes),
                          number(verdict.outside), number(verdict.pulling),
                          number(verdict.untouched), number(verdict.in_matter),
                          mm(verdict.deepest_m), mm(verdict.apart_m)});
  }

  Findings findings_{};
  Table stages_{};
  Table ways_{};
  bool is_admissible_{true};
  bool is_complementary_{true};
  bool is_free_{true};
  bool is_as_drawn_{true};
};

}  // namespace

Result<Findings> run_constraint_models(const ConstraintModelsSettings& settings) {
  std::vector<Scene> scenes = figure_scenes();
  for (const auto& [name, degrees] :
       {std::pair{"acute", 45.0}, std::pair{"right", 90.0}, std::pair{"obtuse", 135.0}}) {
    scenes.push_back(corner_scene(name,
                                  std::string("A corner of ") +
                                      std::to_string(static_cast<int>(degrees)) +
                                      " degrees (figure 3-10)",
                                  degrees * kRad_per_degree));
  }
  FigurePlayer figures;
  for (const Scene& scene : scenes) {
    if (auto played = figures.play(scene); !played) return tl::unexpected(played.error());
  }
  if (auto played = figures.play_random(settings.seed); !played) {
    return tl::unexpected(played.error());
  }
  return std::move(figures).finish(settings.seed);
}

}  // namespace thimble::lab
