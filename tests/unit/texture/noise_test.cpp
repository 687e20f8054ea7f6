// SPDX-License-Identifier: MIT
// The noise against the original's values (textures.md 2, 8.1, 8.2), against a plain second writing of its
// formula, and its properties.
#include "rayshade/texture/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <vector>

#include "rayshade/texture/noise_kernels.h"
#include "rayshade/texture/noise_tables.h"

namespace rayshade {
namespace {

using noise_tables::kGradients;
using noise_tables::kPermutation;

/// CRC-32 of zlib.
std::uint32_t crc32(const std::vector<unsigned char>& data) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const unsigned char byte : data) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) ? (crc >> 1) ^ 0xEDB88320u : crc >> 1;
  }
  return ~crc;
}

TEST(NoiseTables, PermutationIsTheOriginals) {
  const int first[] = {2682, 395,  1334, 1921, 537, 217,  1855, 1283,
                       605,  1305, 3607, 3664, 795, 1388, 1546, 2346};
  for (int i = 0; i < 16; ++i) EXPECT_EQ(kPermutation[i], first[i]) << i;
  const int last[] = {1580, 45, 7, 3848, 1376, 3980, 1861, 170};
  for (int i = 0; i < 8; ++i) EXPECT_EQ(kPermutation[4088 + i], last[i]) << i;
  std::vector<unsigned char> bytes;
  std::int64_t weighted = 0;
  std::vector<bool> seen(4096);
  for (int i = 0; i < 4096; ++i) {
    bytes.push_back(static_cast<unsigned char>(kPermutation[i] & 255));
    bytes.push_back(static_cast<unsigned char>(kPermutation[i] >> 8));
    weighted += std::int64_t{i} * kPermutation[i];
    seen.at(kPermutation[i]) = true;
  }
  EXPECT_EQ(crc32(bytes), 0xa6fbc32cu);
  EXPECT_EQ(weighted, 17677383943);
  EXPECT_EQ(std::count(seen.begin(), seen.end(), false), 0);
}

TEST(NoiseTables, GradientsAreTheOriginals) {
  const auto code = [](int i) { return (kGradients[i] + 1) * 32768; };
  const int first[] = {0,     25938, 21871, 60927, 50535, 37809, 7652, 34394,
                       13692, 27800, 953,   37117, 36332, 64980, 5714, 35537};
  for (int i = 0; i < 16; ++i) EXPECT_EQ(code(i), first[i]) << i;
  const int last[] = {45035, 30711, 28311, 7960};
  for (int i = 0; i < 4; ++i) EXPECT_EQ(code(263 + i), last[i]) << i;
  double sum = 0;
  for (int i = 0; i < 267; ++i) sum += code(i);
  EXPECT_EQ(sum, 8627911);
}

struct NoiseValue {
  Vec3 point;
  double noise;
  Vec3 vector;
};
const NoiseValue kNoiseValues[] = {
    {{0, 0, 0}, -0.033920288085938, {-0.033920288085938, -0.085937500000000, 0.423065185546875}},
    {{0.5, 0.5, 0.5}, 0.216384887695312, {0.216384887695312, 0.119943618774414, 0.331184387207031}},
    {{-0.3, 1.7, 2.2}, -0.515459426235210, {-0.515459426235210, -0.183811309641287, 0.074365935700048}},
    {{1, 0, 0}, -0.107849121093750, {-0.107849121093750, -0.229415893554688, 0.150375366210938}},
    {{0, 1, 0}, 0.225341796875000, {0.225341796875000, -0.165603637695312, 0.426605224609375}},
    {{0, 0, 1}, 0.260864257812500, {0.260864257812500, -0.426208496093750, -0.129058837890625}},
    {{-1, -1, -1}, 0.413497924804688, {0.413497924804688, 0.255920410156250, -0.072601318359375}},
    {{0.25, 0.5, 0.75}, 0.167480289936066, {0.167480289936066, 0.127753280103207, -0.008235786110163}},
    {{-0.25, -0.5, -0.75}, 0.309295680373907, {0.309295680373907, -0.255388803780079, 0.082333214581013}},
    {{0.1, 0.2, 0.3}, 0.081856903100325, {0.081856903100325, -0.179031919088920, 0.402787808055715}},
    {{-0.1, 0.2, -0.3}, -0.214776863430664, {-0.214776863430664, 0.239480874724611, -0.132974532216836}},
    {{1.25, -2.5, 3.75}, 0.177592784166336, {0.177592784166336, 0.123670462518930, -0.159888148307800}},
    {{4097.25, -2.5, 3.75}, 0.177592784166336, {0.177592784166336, 0.123670462518930, -0.159888148307800}},
    {{3.1, 4.1, 5.9}, 0.154089305390793, {0.154089305390793, -0.185225329894688, -0.048147979057819}},
    {{-3.1, -4.1, -5.9}, -0.280766180325649, {-0.280766180325649, 0.081275118784201, 0.273994313237330}},
    {{10.01, 20.02, 30.03}, 0.150187485038733, {0.150187485038733, 0.348644906371765, -0.342959938877639}},
    {{-10.99, 20.5, -30.25}, 0.182444755580173, {0.182444755580173, -0.173100256060112, -0.184179945667555}},
    {{0.999999, 0.5, 0.5}, 0.215549423827777, {0.215549423827777, 0.016906971994855, 0.439663119835561}},
    {{1.000001, 0.5, 0.5}, 0.215549514161144, {0.215549514161144, 0.016906504569779, 0.439662746861561}},
    {{0.5, 0, 0}, -0.199165344238281, {-0.199165344238281, -0.330146789550781, 0.601028442382812}},
    {{0, 0.5, 0}, 0.043632507324219, {0.043632507324219, -0.065460205078125, 0.053169250488281}},
    {{0, 0, 0.5}, 0.075950622558594, {0.075950622558594, -0.331359863281250, 0.420722961425781}},
    {{100.125, 200.25, 300.375},
     0.058618771508918,
     {0.058618771508918, 0.145243500246579, 0.450871225726587}},
    {{-100.125, -200.25, -300.375},
     0.562413202160315,
     {0.562413202160315, 0.566937511324795, -0.101791238561418}},
    {{1234.5, -2345.25, 3456.75},
     -0.074365090578794,
     {-0.074365090578794, 0.468675542622805, 0.008550483733416}},
    {{7.7, 0.3, -12.9}, -0.316740230198065, {-0.316740230198065, -0.426405057218414, 0.097962611951128}},
    {{2.718281828, 3.141592654, 1.414213562},
     0.122640438080678,
     {0.122640438080678, 0.267631569405515, 0.053606846361077}},
    {{-0.001, 0.001, 0}, -0.033455493930336, {-0.033455493930336, -0.085172132834395, 0.421282320838334}},
    {{63.9, 64.1, 127.5}, -0.059922921573984, {-0.059922921573984, -0.001896340443712, -0.058145542993132}},
    {{5000.5, 6000.5, 7000.5}, 0.338636398315430, {0.338636398315430, 0.103799819946289, -0.263914108276367}},
    {{0.33, 0.66, 0.99}, 0.068332590507270, {0.068332590507270, 0.267048443872156, -0.042164200679312}},
    {{-7.125, 8.875, -9.0625},
     -0.400677559807392,
     {-0.400677559807392, 0.363702200251666, -0.048533489997652}},
    {{12.34, -56.78, 9.1}, 0.450298096698325, {0.450298096698325, -0.116837404628137, 0.067816509599057}},
    {{0.05, -0.95, 1.95}, -0.515066797281262, {-0.515066797281261, 0.461682613146830, -0.408513331037943}},
    {{42, 17.5, -8.25}, 0.046606779098511, {0.046606779098511, 0.427613735198975, 0.231951832771301}},
    {{-999999.5, 0.5, 0.5}, 0.038093566894531, {0.038093566894531, 0.132932662963867, -0.253091812133789}},
    {{250000.125, -0.5, 99999.875},
     0.156062406138517,
     {0.156062406138517, -0.081634539616061, -0.022909785941010}},
};

TEST(Noise, HasTheOriginalsValues) {
  for (const NoiseValue& v : kNoiseValues) {
    SCOPED_TRACE(testing::Message() << v.point.x << ", " << v.point.y << ", " << v.point.z);
    EXPECT_NEAR(noise3(v.point), v.noise, 1e-14);
    const Vec3 d = dnoise3(v.point);
    EXPECT_NEAR(d.x, v.vector.x, 1e-14);
    EXPECT_NEAR(d.y, v.vector.y, 1e-14);
    EXPECT_NEAR(d.z, v.vector.z, 1e-14);
  }
}

/// The formula of textures.md 2.2 and 2.3 as it stands there: no shared look-ups, corners in the given order.
double plain_noise(const Vec3& point, int shift, bool around) {
  const double p[3] = {point.x + 1000000, point.y + 1000000, point.z + 1000000};
  const int sweep[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                           {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
  const int walk[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                          {0, 1, 1}, {1, 1, 1}, {1, 0, 1}, {0, 0, 1}};
  double sum = 0;
  for (const auto& corner : around ? walk : sweep) {
    std::int64_t cell[3];
    double weight[3], offset[3];
    for (int k = 0; k < 3; ++k) {
      const std::int64_t base = static_cast<std::int64_t>(std::floor(p[k]));
      const double f = p[k] - static_cast<double>(base);
      const double s = f * f * (3 - 2 * f);
      weight[k] = corner[k] ? s : 1 - s;
      cell[k] = base + corner[k];
      offset[k] = p[k] - static_cast<double>(cell[k]);
    }
    int h = kPermutation[cell[0] & 4095];
    h = kPermutation[h ^ (cell[1] & 4095)];
    h = kPermutation[h ^ (cell[2] & 4095)];
    const int m = (h & 255) + shift;
    sum += weight[0] * weight[1] * weight[2] *
           (0.5 * kGradients[m] + kGradients[m + 1] * offset[0] + kGradients[m + 2] * offset[1] +
            kGradients[m + 3] * offset[2]);
  }
  return sum;
}

class NoiseAtRandomPoints : public testing::Test {
 protected:
  void SetUp() override {
    const unsigned seed = std::random_device{}();
    RecordProperty("seed", static_cast<int>(seed));
    std::printf("seed %u\n", seed);
    random_.seed(seed);
  }
  Vec3 point(double reach) {
    std::uniform_real_distribution<double> d(-reach, reach);
    return {d(random_), d(random_), d(random_)};
  }
  std::mt19937 random_;
};

TEST_F(NoiseAtRandomPoints, IsThePlainFormulaBitForBit) {
  for (int i = 0; i < 20000; ++i) {
    const Vec3 p = point(i % 2 ? 20 : 3e6);  // beyond -1000000 too, where the original broke (D19)
    for (const NoiseKernel& kernel : {scalar_noise_kernel(), best_noise_kernel()}) {
      ASSERT_EQ(kernel.value(p), plain_noise(p, 0, false));
      const Vec3 d = kernel.vector(p);
      ASSERT_EQ(d.x, plain_noise(p, 0, true));
      ASSERT_EQ(d.y, plain_noise(p, 4, true));
      ASSERT_EQ(d.z, plain_noise(p, 8, true));
    }
  }
}

TEST_F(NoiseAtRandomPoints, RepeatsEvery4096) {
  std::uniform_int_distribution<int> shift(-3, 3);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = point(50);
    const Vec3 q = p + 4096.0 * Vec3{double(shift(random_)), double(shift(random_)), double(shift(random_))};
    ASSERT_NEAR(noise3(p), noise3(q), 1e-8);
  }
}

TEST_F(NoiseAtRandomPoints, StaysInItsRangeAndIsCentred) {
  double sum = 0, squares = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double v = noise3(point(1e4));
    ASSERT_GT(v, -1.17);
    ASSERT_LT(v, 1.16);
    sum += v;
    squares += v * v;
  }
  const double mean = sum / n;
  EXPECT_NEAR(mean, -0.0017, 0.005);
  EXPECT_NEAR(std::sqrt(squares / n - mean * mean), 0.2546, 0.005);
}

TEST_F(NoiseAtRandomPoints, IsContinuousAcrossCells) {
  for (int i = 0; i < 2000; ++i) {
    Vec3 below = point(30);
    below.x = std::floor(below.x) - 1e-9;
    Vec3 above = below;
    above.x += 2e-9;
    ASSERT_NEAR(noise3(below), noise3(above), 1e-7);
  }
}

TEST(Noise, TakesAnyNumber) {
  for (const double x : {1e9, -1e9, 1e15, -1e18, 1e19, 1e300, -1e300}) {
    EXPECT_TRUE(std::isfinite(noise3({x, 0.5, 0.5}))) << x;
    EXPECT_LT(std::fabs(noise3({x, 0.5, 0.5})), 1.2) << x;
    EXPECT_TRUE(is_finite(dnoise3({0.5, x, 0.5}))) << x;
  }
  // Cells repeat after 4096, at any size: where all numbers are multiples of a lesser power of two, too.
  for (const double x : {1e15, 4.6e18, 5e18, 9e18, -5e18, 1.3e19, 1e25}) {
    const double cell = std::fmod(x + 1000000, 4096) - 1000000;
    EXPECT_EQ(noise3({x, 0.3, 0.4}), noise3({cell, 0.3, 0.4})) << x;
    EXPECT_EQ(dnoise3({0.3, x, 0.4}), dnoise3({0.3, cell, 0.4})) << x;
  }
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(noise3({0, inf, 0})));
  EXPECT_TRUE(std::isnan(noise3({0, 0, std::nan("")})));
  // At a lattice point only the value of that point is left.
  EXPECT_EQ(noise3({1e300, 1e300, 1e300}),
            0.5 * kGradients[kPermutation[kPermutation[kPermutation[0] ^ 0] ^ 0] & 255]);
}

TEST(NoiseSums, HaveTheOriginalsValues) {
  const Vec3 p{0.1, 0.2, 0.3}, q{1.25, -2.5, 3.75}, r{-3.1, -4.1, -5.9};
  EXPECT_NEAR(chaos(p, 6), 0.196746136671469, 1e-13);
  EXPECT_NEAR(chaos(q, 6), 0.414574176073074, 1e-13);
  EXPECT_NEAR(chaos(q, 7), 0.408219605684280, 1e-13);
  EXPECT_NEAR(chaos(r, 7), -0.442559631255893, 1e-13);
  EXPECT_NEAR(abs_chaos(p, 5), 0.213373314419276, 1e-13);
  EXPECT_NEAR(abs_chaos(q, 6), 0.449200183153152, 1e-13);
  EXPECT_NEAR(marble(p), 0.339862935143263, 1e-13);
  EXPECT_NEAR(marble(q), 0.047793580597034, 1e-13);
  EXPECT_NEAR(marble(r), 0.209555608819514, 1e-13);
  EXPECT_NEAR(fbm(p, 0.5, 2, 5), 0.193009902891188, 1e-13);
  EXPECT_NEAR(fbm(q, 0.5, 2, 5), 0.420097857713699, 1e-13);
  EXPECT_NEAR(fbm(q, 0.5743491774985174, 2, 6), 0.468355813221387, 1e-13);
  EXPECT_NEAR(fbm(r, 0.47619047619047616, 2.1, 5), -0.407946917343108, 1e-13);
}

void expect_vector(const Vec3& v, double x, double y, double z) {
  EXPECT_NEAR(v.x, x, 1e-13);
  EXPECT_NEAR(v.y, y, 1e-13);
  EXPECT_NEAR(v.z, z, 1e-13);
}

TEST(NoiseSums, VectorsHaveTheOriginalsValues) {
  const Vec3 p{0.1, 0.2, 0.3}, q{1.25, -2.5, 3.75};
  expect_vector(vfbm(p, 0.5, 2, 4), 0.176930882295813, -0.055869782993854, 0.509239602379478);
  expect_vector(vfbm(q, 0.5, 2, 7), 0.408219605684280, -0.013275500386953, -0.319247841835022);
  expect_vector(vfbm(q, 0.01, 2, 7), 0.180473526048660, 0.122963118463755, -0.163773830986023);
  const WindyParameters windy{0.7, 1.1, 0.5, 2.2, 0.6, 0.3, 3};
  expect_vector(windy_bump(p, windy), 0.017278993544804, -0.015388994490607, 0.086601014518263);
  expect_vector(windy_bump(q, windy), 0.006912934073358, 0.007722140389359, -0.006129358126609);
  WindyParameters calm = windy;
  calm.chaos_scale = 0;
  expect_vector(windy_bump(q, calm), -0.402358055610574, -0.681697962496388, 0.349211704671945);
}

TEST(NoiseSums, NoOctavesGiveZero) {
  const Vec3 p{0.1, 0.2, 0.3};
  for (const int octaves : {0, -1, -2147483647}) {
    EXPECT_EQ(chaos(p, octaves), 0);
    EXPECT_EQ(abs_chaos(p, octaves), 0);
    EXPECT_EQ(fbm(p, 0.5, 2, octaves), 0);
    EXPECT_EQ(vfbm(p, 0.5, 2, octaves), Vec3{});
  }
}

TEST(NoiseSums, HugeCountsEndAndStayFinite) {
  const Vec3 p{0.1, 0.2, 0.3};
  EXPECT_NEAR(chaos(p, 2147483647), chaos(p, 60), 1e-15);
  EXPECT_NEAR(abs_chaos(p, 2147483647), abs_chaos(p, 60), 1e-15);
  EXPECT_TRUE(std::isfinite(fbm(p, 0.5, 1e9, 2147483647)));
  EXPECT_TRUE(is_finite(windy_bump(p, {1, 1, 1, 1e9, 0.5, 0, 2147483647})));
}

TEST(NoiseSums, OmegaIsHalfForTheCommonParameters) {
  EXPECT_DOUBLE_EQ(fbm_omega(0.5, 2), 0.5);
  EXPECT_DOUBLE_EQ(fbm_omega(0.5, 2.1), 1 / 2.1);
  EXPECT_DOUBLE_EQ(fbm_omega(-0.5, 7), 1);
}

}  // namespace
}  // namespace rayshade
