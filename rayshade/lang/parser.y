// SPDX-License-Identifier: MIT
// The grammar of scene files (language.md 3). No logic here: every action is one call to a builder, or copies a value.
// Numbers of the sections of the language are given at each group of rules.
//
// All optional parts are decided by one token of look-ahead, so the grammar is LALR(1) without conflicts; a change that
// brings one is a mistake in the change, hence `%expect 0`. Look-ahead correction (parse.lac) makes the parser stop at the
// very token that is wrong, before any reduction, so that messages can say what was possible there. Without default
// reductions (lr.default-reduction) a rule that ends in `error` is reduced only once a token has come that can follow it:
// that is what makes `yyerrok` in it safe, and recovery end.

%require "3.8"
%expect 0
%define api.pure full
%define api.prefix {rayshade_lang_}
%define api.token.prefix {TOKEN_}
%define api.value.type {rayshade::lang::SemanticValue}
%define api.location.type {rayshade::lang::GrammarSpan}
%define parse.lac full
%define lr.default-reduction accepting
%define parse.error custom
%locations

%code requires {
#include "rayshade/lang/semantic.h"
#include "rayshade/lang/span.h"
namespace rayshade::lang {
class SceneBuilder;
class Scanner;
}
// Trivially copyable: Bison may grow its stack by copying bytes.
#define RAYSHADE_LANG_STYPE_IS_TRIVIAL 1
#define RAYSHADE_LANG_LTYPE_IS_TRIVIAL 1
}

%param { rayshade::lang::Scanner& scanner }
%parse-param { rayshade::lang::SceneBuilder& b }

%code {
#include "rayshade/lang/builder.h"
#include "rayshade/lang/scanner_state.h"

using namespace rayshade;
using namespace rayshade::lang;

// Deep nesting is refused long before this with a message of its own; what is left are long chains such as "- - - 1".
#define YYMAXDEPTH 1000000
#define YYLLOC_DEFAULT(Current, Rhs, N)                                    \
  do {                                                                     \
    (Current).begin = (N) != 0 ? YYRHSLOC(Rhs, 1).begin : YYRHSLOC(Rhs, 0).end; \
    (Current).end = YYRHSLOC(Rhs, N).end;                                  \
  } while (false)

static int rayshade_lang_lex(YYSTYPE* value, YYLTYPE* span, Scanner& scanner) { return scanner.next(value, span); }
static void rayshade_lang_error(YYLTYPE* span, Scanner&, SceneBuilder& b, const char*) { b.exhausted(*span); }
}

%token END_OF_FILE 0 "end of file"
%token INVALID "a character"
%token <number> FLOAT "a number"
%token <name> WORD "a name" FILENAME "a file name" QUOTED "a quoted file name"

%token
  AMBIENT        "ambient"  APERTURE       "aperture"  APPLYSURF      "applysurf"
  AREA           "area"  ATMOSPHERE     "atmosphere"  BACKGROUND     "background"
  BLOB           "blob"  BLOTCH         "blotch"  BODY           "body"
  BOX            "box"  BUMP           "bump"  CHECKER        "checker"
  CLOUD          "cloud"  COMPONENT      "component"  CONE           "cone"
  CONTRAST       "contrast"  CROP           "crop"  CURSURF        "cursurf"
  CUTOFF         "cutoff"  CYLINDER       "cylinder"  CYLINDRICAL    "cylindrical"
  DEFINE         "define"  DIFFERENCE     "difference"  DIFFUSE        "diffuse"
  DIRECTIONAL    "directional"  DISC           "disc"  END            "end"
  EXTENDED       "extended"  EXTINCT        "extinct"  EYEP           "eyep"
  EYESEP         "eyesep"  FBM            "fbm"  FBMBUMP        "fbmbump"
  FILTER         "filter"  FOCALDIST      "focaldist"  FOG            "fog"
  FOGDECK        "fogdeck"  FOV            "fov"  FRAMELENGTH    "framelength"
  FRAMES         "frames"  GAUSS          "gauss"  GLOSS          "gloss"
  GRID           "grid"  HEIGHTFIELD    "heightfield"  IMAGE          "image"
  INDEX          "index"  INTERSECT      "intersect"  JITTER         "jitter"
  LIGHT          "light"  LIST           "list"  LOOKP          "lookp"
  MAP            "map"  MARBLE         "marble"  MAXDEPTH       "maxdepth"
  MIST           "mist"  MOUNT          "mount"  NAME           "name"
  NOJITTER       "nojitter"  NOSHADOW       "noshadow"  OBJECT         "object"
  OUTFILE        "outfile"  PLANAR         "planar"  PLANE          "plane"
  POINT          "point"  POLY           "poly"  PRINT          "print"
  QUIET          "quiet"  RANGE          "range"  REFLECT        "reflect"
  REPORT         "report"  ROTATE         "rotate"  SAMPLE         "sample"
  SCALE          "scale"  SCREEN         "screen"  SHADOWTRANSP   "shadowtransp"
  SHUTTER        "shutter"  SKY            "sky"  SMOOTH         "smooth"
  SPECPOW        "specpow"  SPECULAR       "specular"  SPHERE         "sphere"
  SPHERICAL      "spherical"  SPOT           "spot"  STARTTIME      "starttime"
  STRIPE         "stripe"  SURFACE        "surface"  TEXTSURF       "textsurf"
  TEXTURE        "texture"  TILE           "tile"  TORUS          "torus"
  TRANSFORM      "transform"  TRANSLATE      "translate"  TRANSLU        "translu"
  TRANSP         "transp"  TRIANGLE       "triangle"  TRIANGLEUV     "triangleuv"
  UNION          "union"  UP             "up"  UV             "uv"
  VERBOSE        "verbose"  WINDOW         "window"  WINDY          "windy"
  WOOD           "wood"

%left '+' '-'
%left '*' '/' '%'
%precedence SIGN
%right '^'

%type <number> expr
%type <integer> int
%type <vector> vec
%type <color> color intensity
%type <name> file
%type <value> aexpr mexpr
%type <arguments> arguments
%type <node> object primitive aggregate placed instance
%type <mapping> mapping_kind
%type <component> component

%destructor { destroy($$); } <value>
%destructor { delete $$; } <arguments>

%%

// 3.3 Top level. After a mistake everything up to the next word that can begin an item is skipped.
scene:
  %empty
| scene item
| scene error                { b.recover(); yyerrok; }
;
item:
  setting
| light
| atmosphere
| definition
| instance                   { b.objects.add($instance); }
;
definition:
  "surface" WORD             { b.surfaces.define($2, @2); }
| "surface" WORD surface     { b.surfaces.define($2, @2); }
| "applysurf" surface        { b.objects.apply_surface(); }
| "name" WORD instance       { b.objects.name($2, @2, $3); }
;

// 3.1 Numbers
expr:
  FLOAT
| '+' FLOAT                  { $$ = $2; }
| '-' FLOAT                  { $$ = -$2; }
| '(' mexpr ')'              { $$ = b.expressions.constant($2, @$); }
;
aexpr:
  FLOAT                      { $$ = {$1, nullptr}; }
| '+' FLOAT                  { $$ = {$2, nullptr}; }
| '-' FLOAT                  { $$ = {-$2, nullptr}; }
| '(' mexpr ')'              { $$ = $2; }
;
int: expr                    { $$ = b.expressions.integer($1, @1); };
vec: expr expr expr          { $$ = Vec3{$1, $2, $3}; };
color: expr expr expr        { $$ = Color{$1, $2, $3}; };
intensity:
  expr                       { $$ = Color{$1, $1, $1}; }
| color
;
file: WORD | FILENAME | QUOTED;

// 3.2 Expressions
mexpr:
  FLOAT                      { $$ = {$1, nullptr}; }
| WORD                       { $$ = b.expressions.variable($1, @1); }
| WORD '(' arguments ')'     { $$ = b.expressions.call($1, @1, $3, @$); }
| '(' mexpr ')'              { $$ = $2; }
| mexpr '+' mexpr            { $$ = b.expressions.binary(Operation::kAdd, $1, $3, @$); }
| mexpr '-' mexpr            { $$ = b.expressions.binary(Operation::kSubtract, $1, $3, @$); }
| mexpr '*' mexpr            { $$ = b.expressions.binary(Operation::kMultiply, $1, $3, @$); }
| mexpr '/' mexpr            { $$ = b.expressions.binary(Operation::kDivide, $1, $3, @$); }
| mexpr '%' mexpr            { $$ = b.expressions.binary(Operation::kRemainder, $1, $3, @$); }
| mexpr '^' mexpr            { $$ = b.expressions.binary(Operation::kPower, $1, $3, @$); }
| '-' mexpr %prec SIGN       { $$ = b.expressions.negate($2, @$); }
| '+' mexpr %prec SIGN       { $$ = $2; }
;
arguments:
  mexpr                      { $$ = b.expressions.first_argument($1); }
| arguments ',' mexpr        { $$ = b.expressions.next_argument($1, $3); }
;

// 3.4 Viewing and rendering
setting:
  "eyep" vec transforms      { b.settings.eye($2, @3, b.transforms.take().empty()); }
| "lookp" vec                { b.settings.look($2); }
| "up" vec                   { b.settings.up($2); }
| "fov" expr                 { b.settings.fov($2); }
| "fov" expr expr            { b.settings.fov($2, $3); }
| "aperture" expr            { b.settings.aperture($2); }
| "focaldist" expr           { b.settings.focal_distance($2); }
| "eyesep" expr              { b.settings.eye_separation($2); }
| "screen" int int           { b.settings.screen($2, $3, @$); }
| "window" int int int int   { b.settings.window($2, $3, $4, $5, @$); }
| "crop" expr expr expr expr { b.settings.crop($2, $3, $4, $5); }
| "sample" int               { b.settings.samples($2, @$); }
| "sample" int "jitter"      { b.settings.samples($2, true, @$); }
| "sample" int "nojitter"    { b.settings.samples($2, false, @$); }
| "filter" filter_kind
| "filter" filter_kind expr  { b.settings.filter_width($3); }
| "contrast" color           { b.settings.contrast($2); }
| "cutoff" intensity         { b.settings.cutoff($2); }
| "maxdepth" int             { b.settings.max_depth($2); }
| "background" color         { b.settings.background($2); }
| "shadowtransp"             { b.settings.toggle_transparent_shadows(); }
| "outfile" file             { b.settings.outfile($2, @2); }
| "report" report_verbose report_quiet report_frequency report_file
| "shutter" expr             { b.settings.shutter($2); }
| "frames" int               { b.settings.frames($2); }
| "starttime" expr           { b.settings.start_time($2); }
| "framelength" expr         { b.settings.frame_length($2); }
| "define" WORD aexpr        { b.expressions.define($2, @2, $3); }
| "print" aexpr              { b.expressions.print($2, @2); }
;
filter_kind:
  "box"                      { b.settings.filter(FilterKind::kBox); }
| "gauss"                    { b.settings.filter(FilterKind::kGauss); }
;
report_verbose: %empty | "verbose" { b.settings.verbose(); };
report_quiet: %empty | "quiet"     { b.settings.quiet(); };
report_frequency: %empty | int     { b.settings.report_frequency($1); };
report_file: %empty | file         { b.settings.report_file($1); };

// 3.5 Lights
light:
  "light" intensity "ambient"            { b.lights.ambient($2); }
| "light" intensity light_kind shadows   { b.lights.finish($2, @$); }
;
light_kind:
  "point" vec                            { b.lights.point($2); }
| "directional" vec                      { b.lights.directional($2, @$); }
| "extended" expr vec                    { b.lights.extended($2, $3); }
| "spot" vec vec expr                    { b.lights.spot($2, $3, $4, @$); }
| "spot" vec vec expr expr expr          { b.lights.spot($2, $3, $4, $5, $6, @$); }
| "area" vec vec int vec int             { b.lights.area($2, $3, $4, $5, $6, @$); }
;
shadows: %empty | "noshadow"             { b.lights.no_shadow(); };

// 3.6 Surfaces
surface:
  surface_start                          { b.surfaces.finish(@$); }
| surface_start components               { b.surfaces.finish(@$); }
| new_surface components                 { b.surfaces.finish(@$); }
;
surface_start:
  WORD                                   { b.surfaces.start_named($1, @1); }
| "cursurf"                              { b.surfaces.start_current(b.objects.current_surface()); }
;
new_surface: %empty                      { b.surfaces.start_new(); };
components: surface_component | components surface_component;
surface_component:
  "ambient" color                        { b.surfaces.change().ambient = $2; }
| "diffuse" color                        { b.surfaces.change().diffuse = $2; }
| "specular" color                       { b.surfaces.change().specular = $2; }
| "body" color                           { b.surfaces.change().body = $2; }
| "specpow" expr                         { b.surfaces.change().specular_exponent = $2; }
| "reflect" expr                         { b.surfaces.change().reflectance = $2; }
| "transp" expr                          { b.surfaces.change().transparency = $2; }
| "index" expr                           { b.surfaces.change().index = $2; }
| "extinct" expr                         { b.surfaces.change().extinction = $2; }
| "translu" expr color expr              { b.surfaces.translucency($2, $3, $4); }
| "noshadow"                             { b.surfaces.change().no_shadow = true; }
;
own_surface: %empty | surface;

// 3.7 Objects
instance:
  placed
| placed textures                        { $$ = b.objects.textured($1, b.textures.take()); }
;
placed: object transforms                { $$ = b.objects.placed($1, b.transforms.take()); };
object:
  primitive
| aggregate
| "object" WORD                          { $$ = b.objects.instance($2, @1, @2); }
| "object" surface WORD                  { $$ = b.objects.instance($3, @1, @3); }
;
primitive:
  "plane" own_surface vec vec                  { $$ = b.shapes.plane(@1, $3, $4); }
| "sphere" own_surface expr vec                { $$ = b.shapes.sphere(@1, $3, $4); }
| "box" own_surface vec vec                    { $$ = b.shapes.box(@1, $3, $4); }
| "disc" own_surface expr vec vec              { $$ = b.shapes.disc(@1, $3, $4, $5); }
| "cylinder" own_surface expr vec vec          { $$ = b.shapes.cylinder(@1, $3, $4, $5); }
| "cone" own_surface expr vec expr vec         { $$ = b.shapes.cone(@1, $3, $4, $5, $6); }
| "torus" own_surface expr expr vec vec        { $$ = b.shapes.torus(@1, $3, $4, $5, $6); }
| "triangle" own_surface vec vec vec           { $$ = b.shapes.triangle(@1, $3, $4, $5); }
| "triangle" own_surface vec vec vec vec vec vec
                                               { $$ = b.shapes.smooth_triangle(@1, $3, $4, $5, $6, $7, $8); }
| "triangleuv" own_surface uv_corner uv_corner uv_corner
                                               { $$ = b.shapes.uv_triangle(@1); }
| "poly" own_surface points                    { $$ = b.shapes.polygon(@1); }
| "blob" own_surface expr balls                { $$ = b.shapes.blob(@1, $3); }
| "heightfield" file                           { $$ = b.shapes.height_field(@1, $2, @2); }
| "heightfield" surface file                   { $$ = b.shapes.height_field(@1, $3, @3); }
;
uv_corner: vec vec expr expr                   { b.shapes.corner($1, $2, $3, $4); };
points: %empty | points vec                    { b.shapes.point($2); };
balls: %empty | balls expr expr vec            { b.shapes.ball($2, $3, $4); };

aggregate: aggregate_start members "end"       { $$ = b.objects.close(@1); };
aggregate_start:
  "list"                                       { b.objects.open(NodeKind::kList, @1); }
| "grid" int int int                           { b.objects.open_grid($2, $3, $4, @$); }
| "grid" error                                 { b.objects.open_grid(1, 1, 1, @1); yyerrok; }
| "union"                                      { b.objects.open(NodeKind::kUnion, @1); }
| "intersect"                                  { b.objects.open(NodeKind::kIntersect, @1); }
| "difference"                                 { b.objects.open(NodeKind::kDifference, @1); }
;
members:
  %empty
| members member
| members error                                { b.recover(); yyerrok; }
;
member:
  instance                                     { b.objects.add($1); }
| definition
;

// 3.8 Transforms
transforms: %empty | transforms transform;
transform:
  "scale" aexpr aexpr aexpr                    { b.transforms.scale($2, $3, $4, @$); }
| "translate" aexpr aexpr aexpr                { b.transforms.translate($2, $3, $4, @$); }
| "rotate" aexpr aexpr aexpr aexpr             { b.transforms.rotate($2, $3, $4, $5, @$); }
| "transform" matrix                           { b.transforms.matrix(@$); }
| "transform" matrix row                       { b.transforms.matrix(@$); }
;
matrix: row row row;
row: aexpr aexpr aexpr                         { b.transforms.row($1, $2, $3); };

// 3.9 Textures
textures: texture | textures texture;
texture: "texture" texture_kind transforms     { b.textures.finish(b.transforms.take(), @$); };
texture_kind:
  "checker" surface                            { b.textures.start(TextureKind::kChecker, b.surfaces.value()); }
| "blotch" expr surface                        { b.textures.start(TextureKind::kBlotch, b.surfaces.value(), {$2}); }
| "bump" expr                                  { b.textures.start(TextureKind::kBump, {$2}); }
| marble
| marble file                                  { b.textures.file($2, @2); }
| fbm
| fbm file                                     { b.textures.file($2, @2); }
| "fbmbump" expr expr expr expr int            { b.textures.start(TextureKind::kFbmBump, {$2, $3, $4, $5}, $6, @6); }
| "wood"                                       { b.textures.start(TextureKind::kWood); }
| "gloss" expr                                 { b.textures.start(TextureKind::kGloss, {$2}); }
| "cloud" expr expr expr int expr expr expr    { b.textures.start(TextureKind::kCloud, {$2, $3, $4, $6, $7, $8}, $5, @5); }
| "sky" expr expr expr int expr expr           { b.textures.start(TextureKind::kSky, {$2, $3, $4, $6, $7}, $5, @5); }
| "stripe" stripe
| "stripe" stripe mapping
| "windy" expr expr expr expr int expr expr expr
                     { b.textures.start(TextureKind::kWindy, {$2, $3, $4, $5, $7, $8, $9}, $6, @6); }
| "mount" file expr expr      { b.textures.start(TextureKind::kMount, $2, @2, {$3, $4}); }
| image
;
marble: "marble"                               { b.textures.start(TextureKind::kMarble); };
fbm: "fbm" expr expr expr expr int expr        { b.textures.start(TextureKind::kFbm, {$2, $3, $4, $5, $7}, $6, @6); };
stripe: surface expr expr                      { b.textures.start(TextureKind::kStripe, b.surfaces.value(), {$2, $3}); };
image:
  "image" file                                 { b.textures.start(TextureKind::kImage, $2, @2); }
| image image_option
;
image_option:
  "component" component                        { b.textures.image().component = $2; }
| "tile" expr expr                             { b.textures.tile($2, $3); }
| "textsurf" surface                           { b.textures.second_surface(b.surfaces.value()); }
| "range" expr expr                            { b.textures.range($2, $3); }
| "smooth"                                     { b.textures.image().smooth = true; }
| mapping
;
component:
  "ambient"                                    { $$ = ImageComponent::kAmbient; }
| "diffuse"                                    { $$ = ImageComponent::kDiffuse; }
| "specular"                                   { $$ = ImageComponent::kSpecular; }
| "body"                                       { $$ = ImageComponent::kBody; }
| "reflect"                                    { $$ = ImageComponent::kReflect; }
| "transp"                                     { $$ = ImageComponent::kTransp; }
| "specpow"                                    { $$ = ImageComponent::kSpecpow; }
| "bump"                                       { $$ = ImageComponent::kBump; }
| "index"                                      { $$ = ImageComponent::kIndex; }
;
mapping:
  "map" "uv"                                   { b.textures.mapping(MappingKind::kUv); }
| "map" mapping_kind                           { b.textures.mapping($2); }
| "map" mapping_kind vec vec vec               { b.textures.mapping($2, $3, $4, $5, @$); }
;
mapping_kind:
  "spherical"                                  { $$ = MappingKind::kSpherical; }
| "cylindrical"                                { $$ = MappingKind::kCylindrical; }
| "planar"                                     { $$ = MappingKind::kPlanar; }
;

// 3.10 Atmosphere
atmosphere: atmosphere_start | atmosphere effect;
atmosphere_start:
  "atmosphere"                                 { b.settings.atmosphere(); }
| "atmosphere" expr                            { b.settings.atmosphere($2, @2); }
;
effect:
  "fog" color color                            { b.settings.fog($2, $3); }
| "mist" color color expr expr                 { b.settings.mist($2, $3, $4, $5); }
| "fogdeck" expr expr vec expr int color color { b.settings.fogdeck($2, $3, $4, $5, $6, $7, $8, @6); }
;

%%

// A syntax error, told in the names of the grammar; the words are chosen by SceneBuilder.
static int yyreport_syntax_error(const yypcontext_t* context, Scanner& scanner, SceneBuilder& b) {
  constexpr int kMost = YYNTOKENS;
  yysymbol_kind_t kinds[kMost];
  const int count = yypcontext_expected_tokens(context, kinds, kMost);
  std::vector<std::string_view> expected;
  for (int i = 0; i < count; ++i) expected.emplace_back(yysymbol_name(kinds[i]));
  b.syntax_error(*yypcontext_location(context), yysymbol_name(yypcontext_token(context)), expected, scanner);
  return 0;
}

namespace rayshade::lang {
void run_parser(Scanner& scanner, SceneBuilder& builder) { yyparse(scanner, builder); }
}
