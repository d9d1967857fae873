# cmake -DDEP_LAYER=n -P: a module of layer 2 depends on one of layer n. Fails configure when n > 2.
include(${CMAKE_CURRENT_LIST_DIR}/../../cmake/enamel_module.cmake)
enamel_assert_layer(upper 2 lower ${DEP_LAYER})
