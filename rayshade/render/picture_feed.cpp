// SPDX-License-Identifier: MIT
#include "rayshade/render/picture_feed.h"

namespace rayshade {

PictureFeed::PictureFeed(const FrameJob& job, int block_side) : job_(job), side_(block_side) {
  const FrameBuffer& picture = job.picture;
  const BlockGrid grid(static_cast<int>(picture.width()), static_cast<int>(picture.height()), side_);
  for (std::int64_t number = 0; number < grid.count(); ++number) {
    const Block block = grid.block(number);
    if (!picture.is_present(block.x, block.y, block.width, block.height)) blocks_.push_back(block);
  }
  progress_.blocks = missing();
  progress_.pixels = picture.width() * picture.height();
  progress_.pixels_before = progress_.pixels_done = picture.present();
}

std::optional<Block> PictureFeed::next() {
  if (job_.stop.load(std::memory_order_relaxed) || closed_.load(std::memory_order_relaxed)) return {};
  const std::size_t i = next_.fetch_add(1, std::memory_order_relaxed);
  if (i >= blocks_.size()) return {};
  return blocks_[i];
}

void PictureFeed::finished(const Block& block, EncodedBlock&& pixels, const BlockCost& cost) {
  if (job_.keep || job_.cost) {
    const std::lock_guard lock(mutex_);
    if (job_.keep) job_.keep(pixels);
    if (job_.cost) job_.cost(block, cost);
  }
  job_.picture.put(pixels);
  const std::lock_guard lock(mutex_);
  ++progress_.blocks_done;
}

FrameProgress PictureFeed::progress() {
  const std::lock_guard lock(mutex_);
  const FrameBuffer& picture = job_.picture;
  while (progress_.rows_done < picture.height() && picture.row_complete(progress_.rows_done))
    ++progress_.rows_done;
  progress_.pixels_done = picture.present();
  return progress_;
}

}  // namespace rayshade
