-- title: two strokes
SetUser(1, {-150.000, -650.000, 20.000, 0.00000, 0.00000, 0.00000})
SetTool(1, {0.000, 0.000, 150.000, 0.00000, 0.00000, 0.00000})
User(1)
Tool(1)
CP(0)

function on_paper(x, y, z)
  return {pose = {x, y, z, 180.00000, 0.00000, 0.00000}}
end

-- stroke 1 of 3: n/1
here = GetPose(1, 1).pose
if here[3] < 20.000 then
  here[3] = 20.000
  MovL({pose = here}, {speed = 50})
end
MovL(on_paper(10.000, 10.000, 20.000), {speed = 100})
MovL(on_paper(10.000, 10.000, 2.000), {speed = 25})
MovL(on_paper(10.000, 10.000, 0.000), {speed = 10})
MovL(on_paper(12.500, 10.000, -3.000), {speed = 20})
MovL(on_paper(30.123, 20.988, -3.250), {speed = 20})
MovL(on_paper(40.000, 24.000, -3.250), {speed = 20})
MovL(on_paper(38.000, 23.500, 0.000), {speed = 20})
MovL(on_paper(38.000, 23.500, 2.000), {speed = 10})
MovL(on_paper(38.000, 23.500, 20.000), {speed = 100})

-- stroke 2 of 3: dot
MovL(on_paper(40.000, 30.000, 20.000), {speed = 100})
MovL(on_paper(40.000, 30.000, 2.000), {speed = 25})
MovL(on_paper(40.000, 30.000, 0.000), {speed = 10})
MovL(on_paper(40.000, 30.000, -2.000), {speed = 10})
MovL(on_paper(43.000, 30.000, -2.000), {speed = 20})
MovL(on_paper(42.000, 30.000, 0.000), {speed = 20})
MovL(on_paper(42.000, 30.000, 2.000), {speed = 10})
MovL(on_paper(42.000, 30.000, 20.000), {speed = 100})

-- stroke 3 of 3: turn
MovL(on_paper(12.000, 10.000, 20.000), {speed = 100})
MovL(on_paper(12.000, 10.000, 2.000), {speed = 25})
MovL(on_paper(12.000, 10.000, 0.000), {speed = 10})
MovL(on_paper(12.000, 30.000, -2.000), {speed = 20})
Arc(on_paper(15.678, 36.732, -2.000), on_paper(23.329, 37.274, -2.000), {speed = 20})
MovL(on_paper(30.000, 45.000, -2.000), {speed = 20})
MovL(on_paper(30.000, 44.000, 0.000), {speed = 20})
MovL(on_paper(30.000, 44.000, 2.000), {speed = 10})
MovL(on_paper(30.000, 44.000, 20.000), {speed = 100})

-- end: the brush is held up
