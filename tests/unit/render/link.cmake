#Rendering is tested from scene text.
target_link_libraries(render_test PRIVATE rayshade_lang)
