# What tests of 20 seconds and more take (of a release build, on two busy cores, three at a time, with kernels to compile): ctest starts
# those first that cost most, also where it has not run before, so that none is left to run alone at the end. The costs of the others are
# what ctest has noted in the folder of the build.
function(costs test seconds)
  set_tests_properties(${test} PROPERTIES COST ${seconds})
endfunction()
costs(Validation.QuickRun 123)
costs(OpenclProgram.TheFormForGpusGivesTheSameBytes 99)
costs(RatesOfEstimators.NoMoreFalseAlarmsThanStated 97)
costs(OpenclFault.EveryWait 62)
costs(Viewer.page_render 54)
costs(Viewer.page_pages 40)
costs(Power.TheDetectableBiasIsDetected 35)
costs(RatesOfFewReplicates.NoMoreFalseAlarmsThanStated 25)
costs(Uniformity.NoiseThatPixelsShareRaisesNoFalseAlarms 23)
costs(Methods.AgreeOnEveryScene 21)
costs(Checker.NoReports 20)
