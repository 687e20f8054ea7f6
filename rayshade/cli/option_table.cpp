// SPDX-License-Identifier: MIT
#include <limits>

#include "rayshade/cli/options.h"
#include "rayshade/image/format.h"

namespace rayshade {
namespace {

using Values = std::span<const std::string>;

constexpr int kMax = std::numeric_limits<int>::max();
constexpr const char* kScene = "Scene";
constexpr const char* kView = "View and window";
constexpr const char* kSampling = "Sampling and shading";
constexpr const char* kAnimation = "Animation";
constexpr const char* kPicture = "Picture";
constexpr const char* kRun = "Run";
constexpr const char* kReport = "Reports";

Color color(Values v, const std::string& option) {
  return {parse_real(v[0], option), parse_real(v[1], option), parse_real(v[2], option)};
}

void preview(Options& o) {
  o.settings.no_shadows = true;
  o.settings.max_depth = 0;
  o.settings.samples = 1;
  o.settings.jitter = true;
}

Preprocess flipped(Preprocess now) {
  return now == Preprocess::kNever ? Preprocess::kAuto : Preprocess::kNever;
}

std::vector<OptionSpec> make_table() {
  std::vector<OptionSpec> t;
  // Scene
  t.push_back(
      {'P',
       "preprocessor-args",
       {"ARGS"},
       kScene,
       "Preprocess the scene, with these arguments: -Dname, -Dname=text, -Uname, -Idir, separated by blanks. "
       "Replaces an earlier -P.",
       [](Options& o, Values v) { o.preprocessor_arguments = v[0]; }});
  t.push_back({'u',
               "toggle-preprocessor",
               {},
               kScene,
               "Toggle preprocessing, which is otherwise done when the scene has a directive or -P is given.",
               [](Options& o, Values) { o.preprocess = flipped(o.preprocess); }});
  t.push_back({'f',
               "flip-normals",
               {},
               kScene,
               "Toggle flipping of the normals of polygons and triangles.",
               [](Options& o, Values) { o.settings.flip_normals = !o.settings.flip_normals; }});
  t.push_back({0,
               "check",
               {},
               kScene,
               "Read the scene and report its errors and warnings; render nothing.",
               [](Options& o, Values) { o.action = Action::kCheck; }});
  t.push_back({0,
               "dump-scene",
               {},
               kScene,
               "Write the scene as canonical text to standard output (or to the file of -O) and render "
               "nothing. Its hash names the scene.",
               [](Options& o, Values) { o.action = Action::kDumpScene; }});

  // View and window
  t.push_back({'R',
               "resolution",
               {"X", "Y"},
               kView,
               "Set the size of the screen in pixels.",
               [](Options& o, Values v) {
                 const int x = parse_int(v[0], "-R", -1, kMax), y = parse_int(v[1], "-R", -1, kMax);
                 o.settings.screen = {x, y};
               }});
  t.push_back({'W',
               "window",
               {"X0", "X1", "Y0", "Y1"},
               kView,
               "Render only this window of the screen, in pixels, ends included; rows count from the top.",
               [](Options& o, Values v) {
                 std::array<int, 4> w{};
                 for (std::size_t i = 0; i < 4; ++i) w[i] = parse_int(v[i], "-W", -kMax, kMax);
                 o.settings.window = w;
               }});
  t.push_back({'X',
               "crop",
               {"L", "R", "B", "T"},
               kView,
               "Render only this part of the window, as fractions of its width and height.",
               [](Options& o, Values v) {
                 std::array<double, 4> c{};
                 for (std::size_t i = 0; i < 4; ++i) c[i] = parse_real(v[i], "-X");
                 o.settings.crop = c;
               }});
  t.push_back({'l',
               "left-eye",
               {},
               kView,
               "Render the view of the left eye of a stereo pair.",
               [](Options& o, Values) { o.settings.eye = Eye::kLeft; }});
  t.push_back({'r',
               "right-eye",
               {},
               kView,
               "Render the view of the right eye of a stereo pair.",
               [](Options& o, Values) { o.settings.eye = Eye::kRight; }});
  t.push_back({'E',
               "eye-separation",
               {"DISTANCE"},
               kView,
               "Set the separation of the eyes.",
               [](Options& o, Values v) { o.settings.eye_separation = parse_real(v[0], "-E"); }});

  // Sampling and shading
  t.push_back(
      {'S',
       "samples",
       {"N"},
       kSampling,
       "Take at most N x N samples per pixel, N from 1 to 64.",
       [](Options& o, Values v) { o.settings.samples = std::max(1, parse_int(v[0], "-S", -kMax, 64)); }});
  t.push_back(
      {0,
       "sampling",
       {"KIND"},
       kSampling,
       "Where samples lie: original (jittered grids, refined by contrast as Rayshade 4.0 does), or sobol "
       "(scrambled low-discrepancy points over pixel, lens, shutter and lights together, as many in each "
       "pixel as its error needs, -S and --tolerance being the limits).",
       [](Options& o, Values v) {
         if (v[0] == "original")
           o.settings.sampling = SamplingKind::kOriginal;
         else if (v[0] == "sobol")
           o.settings.sampling = SamplingKind::kSobol;
         else
           throw UsageError("--sampling: '" + v[0] + "' is neither original nor sobol");
       },
       {"original", "sobol"}});
  t.push_back(
      {0,
       "tolerance",
       {"T"},
       kSampling,
       "With --sampling sobol: the estimated standard error, in units of the picture's full range, at "
       "which a pixel of nine samples gets no more; 0.01 without it, 0 for all samples everywhere.",
       [](Options& o, Values v) {
         const double tolerance = parse_real(v[0], "--tolerance");
         if (!(tolerance >= 0 && tolerance <= 1))
           throw UsageError("--tolerance: '" + v[0] + "' is not a number from 0 to 1");
         o.settings.tolerance = tolerance;
       }});
  t.push_back({'j',
               "toggle-jitter",
               {},
               kSampling,
               "Toggle jittered sampling, which is otherwise on, whatever the scene says.",
               [](Options& o, Values) { o.settings.jitter = !o.settings.jitter.value_or(true); }});
  t.push_back({'T',
               "contrast",
               {"R", "G", "B"},
               kSampling,
               "Set the contrast above which a pixel gets all its samples.",
               [](Options& o, Values v) { o.settings.contrast = color(v, "-T"); }});
  t.push_back({'g',
               "toggle-gauss",
               {},
               kSampling,
               "Toggle the Gaussian pixel filter, which is otherwise off, whatever the scene says.",
               [](Options& o, Values) {
                 o.settings.filter =
                     o.settings.filter == FilterKind::kGauss ? FilterKind::kBox : FilterKind::kGauss;
               }});
  t.push_back({'C',
               "cutoff",
               {"R", "G", "B"},
               kSampling,
               "Set the contribution below which secondary rays are not traced.",
               [](Options& o, Values v) { o.settings.cutoff = color(v, "-C"); }});
  t.push_back({'D',
               "max-depth",
               {"N"},
               kSampling,
               "Set the largest number of reflections and refractions along a ray.",
               [](Options& o, Values v) { o.settings.max_depth = parse_int(v[0], "-D", -kMax, 60'000); }});
  t.push_back({'n',
               "toggle-shadows",
               {},
               kSampling,
               "Toggle shadows, which are otherwise on.",
               [](Options& o, Values) { o.settings.no_shadows = !o.settings.no_shadows; }});
  t.push_back({'o',
               "toggle-transparent-shadows",
               {},
               kSampling,
               "Toggle whether transparent objects let light through, in addition to what the scene says.",
               [](Options& o, Values) {
                 o.settings.toggle_transparent_shadows = !o.settings.toggle_transparent_shadows;
               }});
  t.push_back({'p',
               "preview",
               {},
               kSampling,
               "Preview: no shadows, depth 0, one jittered sample per pixel.",
               [](Options& o, Values) { preview(o); }});
  t.push_back({'s',
               "toggle-shadow-cache",
               {},
               kSampling,
               "Accepted for compatibility; caches never change the picture.",
               [](Options& o, Values) { o.shadow_cache = !o.shadow_cache; }});
  t.push_back(
      {0, "seed", {"N"}, kSampling, "Seed of all random numbers; 0 without it.", [](Options& o, Values v) {
         const std::string& s = v[0];
         std::size_t used = 0;
         try {
           if (s.empty() || s[0] < '0' || s[0] > '9') throw std::invalid_argument(s);
           o.settings.seed = std::stoull(s, &used);
         } catch (const std::exception&) {
           used = 0;
         }
         if (used != s.size() || used == 0)
           throw UsageError("--seed: '" + s + "' is not a number from 0 to 2^64-1");
       }});

  // Animation
  t.push_back({'A',
               "first-frame",
               {"N"},
               kAnimation,
               "Number of the first frame to render.",
               [](Options& o, Values v) {
                 o.settings.first_frame = parse_int(v[0], "-A", -1'000'000'000, 1'000'000'000);
               }});
  t.push_back({'N', "frames", {"N"}, kAnimation, "Number of frames to render.", [](Options& o, Values v) {
                 const double n = parse_real(v[0], "-N");
                 if (!(n > -1e9 && n < 1e9)) throw UsageError("-N: '" + v[0] + "' is out of range");
                 o.settings.frames = static_cast<int>(n);
               }});

  // Picture
  t.push_back({'O',
               "output",
               {"FILE"},
               kPicture,
               "Write the picture to FILE; '-' is standard output. Without it the scene's outfile, else "
               "standard output. A name with %d or %04d holds the number of the frame.",
               [](Options& o, Values v) { o.output = v[0]; },
               {"FILE"}});
  t.push_back({0,
               "format",
               {"FORMAT"},
               kPicture,
               "Format of the picture: png, png16, ppm, pfm, exr, rle or raw. Otherwise told by the suffix "
               "of the file; png where there is none.",
               [](Options& o, Values v) {
                 format_by_name(v[0]);  // complains at once
                 o.format = v[0];
               },
               {"png", "png16", "ppm", "pfm", "exr", "rle", "raw"}});
  t.push_back({'G',
               "gamma",
               {"G"},
               kPicture,
               "Display gamma: stored values are v^(1/G). 1 without it.",
               [](Options& o, Values v) { o.gamma = parse_real(v[0], "-G"); }});
  t.push_back({0,
               "srgb",
               {},
               kPicture,
               "Store values by the sRGB transfer function, and say so in the file.",
               [](Options& o, Values) { o.srgb = true; }});
  t.push_back({'a',
               "toggle-alpha",
               {},
               kPicture,
               "Toggle the alpha channel of RLE, PNG and EXR pictures.",
               [](Options& o, Values) { o.alpha = !o.alpha; }});
  t.push_back({'e',
               "exponential",
               {},
               kPicture,
               "Write an exponential RLE picture (red, green, blue, exponent).",
               [](Options& o, Values) { o.exponential = true; }});
  t.push_back({'m',
               "toggle-sample-map",
               {},
               kPicture,
               "Toggle the sample map: alpha tells which pixels got all their samples.",
               [](Options& o, Values) { o.sample_map = !o.sample_map; }});
  t.push_back({0,
               "layers",
               {"FILE"},
               kPicture,
               "Also write depth, normal, object and samples of each pixel: as layers of FILE if it is an "
               "EXR file (then the picture must be EXR or PFM), else as FILE with the name of the layer "
               "before its suffix.",
               [](Options& o, Values v) { o.layers = v[0]; },
               {"FILE"}});

  // Run
  t.push_back({0,
               "threads",
               {"N"},
               kRun,
               "Number of threads; 0 (the default) is what the process may use.",
               [](Options& o, Values v) { o.threads = parse_int(v[0], "--threads", 0, 4096); }});
  t.push_back(
      {0,
       "intersector",
       {"NAME"},
       kRun,
       "How rays find objects: fas (adaptive subdivision by classes of rays, the default), hierarchy "
       "(a bounding hierarchy alone) or brute (every object for every ray; the oracle). The picture is the "
       "same.",
       [](Options& o, Values v) {
         if (v[0] == "brute")
           o.intersector = IntersectorKind::kBruteForce;
         else if (v[0] == "hierarchy")
           o.intersector = IntersectorKind::kHierarchy;
         else if (v[0] == "fas")
           o.intersector = IntersectorKind::kFas;
         else
           throw UsageError("--intersector: '" + v[0] + "' is neither fas nor hierarchy nor brute");
       },
       {"fas", "hierarchy", "brute"}});
  t.push_back(
      {0,
       "fas-memory",
       {"SIZE"},
       kRun,
       "Memory that the trees of adaptive subdivision may take, for example 500M or 2G (default: a quarter "
       "of what the process may use). At the bound they stop growing; the picture is the same.",
       [](Options& o, Values v) { o.fas_memory = parse_bytes(v[0], "--fas-memory"); }});
  t.push_back(
      {0,
       "fas-split",
       {"WHEN"},
       kRun,
       "When cells of the trees are split: adaptive (when it pays, the default) or always (as deep as cells "
       "go, for study). The picture is the same.",
       [](Options& o, Values v) {
         if (v[0] == "adaptive")
           o.fas_split = fas::Split::kAdaptive;
         else if (v[0] == "always")
           o.fas_split = fas::Split::kAlways;
         else
           throw UsageError("--fas-split: '" + v[0] + "' is neither adaptive nor always");
       },
       {"adaptive", "always"}});
  t.push_back(
      {0,
       "verify",
       {"SHARE"},
       kRun,
       "Ask brute force again about this share of all rays, from 0 to 1 or from 0% to 100%, while rendering. "
       "Answers that differ are counted, the first ten printed, and the exit status is 4.",
       [](Options& o, Values v) { o.verify = parse_share(v[0], "--verify"); }});
  t.push_back({0,
               "block",
               {"N"},
               kRun,
               "Side of the blocks that threads render, in pixels. The picture is the same.",
               [](Options& o, Values v) { o.block = parse_int(v[0], "--block", 1, 65'536); }});
  t.push_back({0,
               "memory",
               {"SIZE"},
               kRun,
               "Refuse to start where more than SIZE bytes (suffix K, M, G) would be needed. Default: what "
               "the machine or the job has available.",
               [](Options& o, Values v) { o.memory_limit = parse_bytes(v[0], "--memory"); }});
  t.push_back({'c',
               "continue",
               {},
               kRun,
               "Continue an interrupted rendering from its journal. An error where the journal is of another "
               "scene or of other options; without -c such a journal is replaced, and one that matches is "
               "continued all the same.",
               [](Options& o, Values) { o.resume = true; }});
  t.push_back({0,
               "no-journal",
               {},
               kRun,
               "Neither keep a journal of finished blocks (FILE.journal beside the picture) nor use one.",
               [](Options& o, Values) { o.no_journal = true; }});
  t.push_back({0,
               "partial",
               {},
               kRun,
               "Keep the unfinished picture beside the place of the finished one while rendering, as "
               "NAME.partial.SUFFIX.",
               [](Options& o, Values) { o.partial = true; }});
  t.push_back({0,
               "partial-interval",
               {"SECONDS"},
               kRun,
               "Write the unfinished picture anew every so many seconds (30 without it), but never for more "
               "than a twentieth of the time. Implies --partial.",
               [](Options& o, Values v) {
                 o.partial = true;
                 o.partial_interval = parse_real(v[0], "--partial-interval");
                 if (!(o.partial_interval >= 0 && o.partial_interval <= 1e9))
                   throw UsageError("--partial-interval: '" + v[0] + "' is not a number of seconds");
               }});

  // Reports
  t.push_back({'q', "quiet", {}, kReport, "Print nothing but warnings and errors.", [](Options& o, Values) {
                 o.quiet = true;
               }});
  t.push_back(
      {'v', "verbose", {}, kReport, "Print settings, objects and full statistics.", [](Options& o, Values) {
         o.verbose = true;
       }});
  t.push_back({'V',
               "report-file",
               {"FILE"},
               kReport,
               "Like -v, and write the report to FILE.",
               [](Options& o, Values v) {
                 if (v[0].starts_with("-"))
                   throw UsageError("-V: needs the name of a file, not '" + v[0] + "'");
                 o.verbose = true;
                 o.report_file = v[0];
               },
               {"FILE"}});
  t.push_back(
      {'F',
       "report-frequency",
       {"N"},
       kReport,
       "Print a plain progress line every N rows.",
       [](Options& o, Values v) { o.report_frequency = std::max(1, parse_int(v[0], "-F", -kMax, kMax)); }});
  t.push_back({0,
               "stats",
               {"FILE"},
               kReport,
               "Write all statistics to FILE as JSON.",
               [](Options& o, Values v) { o.stats_file = v[0]; },
               {"FILE"}});
  t.push_back({0,
               "cost-map",
               {"FILE"},
               kReport,
               "Write intersection tests, box tests, microseconds, rays, and rays answered by trees of each "
               "pixel as float "
               "pictures FILE.tests.pfm, FILE.bounds_tests.pfm, FILE.microseconds.pfm, FILE.rays.pfm and "
               "FILE.tree_rays.pfm, "
               "and each in false colours as a PNG beside it.",
               [](Options& o, Values v) { o.cost_map = v[0]; },
               {"FILE"}});
  t.push_back(
      {0,
       "block-costs",
       {"FILE"},
       kReport,
       "Write what each block took, for the simulator and the schedules of pafas(1). Of several frames the "
       "last counts.",
       [](Options& o, Values v) { o.block_costs = v[0]; },
       {"FILE"}});
  t.push_back(
      {0,
       "fas-dump",
       {"FILE.svg"},
       kReport,
       "Draw the tree of eye rays over the picture: every cell of its subdivision, shaded by the "
       "number of objects to be tested there. All rays go through trees then, even where that is "
       "slower. Refused where there is no such tree: with a lens, few objects, or another intersector.",
       [](Options& o, Values v) { o.fas_dump = v[0]; },
       {"FILE"}});
  t.push_back({0,
               "explain",
               {"X", "Y"},
               kReport,
               "Print the ray tree of one pixel of the screen: every hit, light, weight and colour. Renders "
               "nothing else.",
               [](Options& o, Values v) {
                 o.action = Action::kExplain;
                 o.explain_x = parse_int(v[0], "--explain", 0, kMax);
                 o.explain_y = parse_int(v[1], "--explain", 0, kMax);
               }});
  t.push_back({'h', "help", {}, kReport, "Print this help and exit.", [](Options& o, Values) {
                 o.action = Action::kHelp;
               }});
  t.push_back({0, "version", {}, kReport, "Print the version and exit.", [](Options& o, Values) {
                 o.action = Action::kVersion;
               }});
  t.push_back({0,
               "man-options",
               {},
               kReport,
               "Print the OPTIONS section of the manual page and exit.",
               [](Options& o, Values) { o.action = Action::kManOptions; }});
  t.push_back({0,
               "bash-completion",
               {},
               kReport,
               "Print a completion script for bash and exit.",
               [](Options& o, Values) { o.action = Action::kCompletion; }});
  return t;
}

}  // namespace

const std::vector<OptionSpec>& option_table(Program program) {
  static const std::vector<OptionSpec> table = make_table();
  static const std::vector<OptionSpec> with_cluster = [] {
    std::vector<OptionSpec> all = cluster_option_table();
    all.insert(all.begin(), table.begin(), table.end());
    return all;
  }();
  return program == Program::kPafas ? with_cluster : table;
}

}  // namespace rayshade
