-- Dobot's commands as its manual for controller 4 describes them, for an arm without errors.
--
-- lua5.4 dobot.lua FLANGE ... < program: each FLANGE "x,y,z,rx,ry,rz" [mm, degrees] is where a run begins.
-- The first run prints all its actions. The others print how they begin and how many moves they have. Each action is
-- one line: kind, line, numbers. A place is twelve numbers, the rows of the flange's frame in the base.

local FASTEST, HARDEST, LEAST_SPEED, WIDEST = 2000.0, 5000.0, 1, 100
local LISTED = {[0] = true, [1] = true} -- frames that a user has added
local KEYS = {user = true, tool = true, a = true, v = true, speed = true, cp = true, r = true, stopcond = true}
local STEPS = 1000000000

local function times(a, b)
  local c = {}
  for row = 0, 2 do
    for k = 1, 4 do
      local sum = k == 4 and a[4 * row + 4] or 0.0
      for j = 1, 3 do
        sum = sum + a[4 * row + j] * b[4 * (j - 1) + k]
      end
      c[4 * row + k] = sum
    end
  end
  return c
end

local function back(a)
  local c = {}
  for row = 0, 2 do
    for k = 1, 3 do
      c[4 * row + k] = a[4 * (k - 1) + row + 1]
    end
    c[4 * row + 4] = -(a[row + 1] * a[4] + a[row + 5] * a[8] + a[row + 9] * a[12])
  end
  return c
end

-- about the fixed x, then y, then z axis
local function frame_of(p)
  local a, b, g = math.rad(p[4]), math.rad(p[5]), math.rad(p[6])
  local sa, ca, sb, cb, sg, cg = math.sin(a), math.cos(a), math.sin(b), math.cos(b), math.sin(g), math.cos(g)
  return {
    cg * cb, cg * sb * sa - sg * ca, cg * sb * ca + sg * sa, p[1],
    sg * cb, sg * sb * sa + cg * ca, sg * sb * ca - cg * sa, p[2],
    -sb, cb * sa, cb * ca, p[3],
  }
end

local function pose_of(m)
  local across = math.sqrt(m[1] * m[1] + m[5] * m[5])
  local angles = {math.atan(m[10], m[11]), math.atan(-m[9], across), math.atan(m[5], m[1])}
  return {m[4], m[8], m[12], math.deg(angles[1]), math.deg(angles[2]), math.deg(angles[3])}
end

local function number(value, what)
  if type(value) ~= "number" or value ~= value or value == math.huge or value == -math.huge then
    error(what .. " is no number", 0)
  end
  return value
end

local function six(list, what)
  if type(list) ~= "table" or #list ~= 6 then
    error(what .. " has not six numbers", 0)
  end
  for k in pairs(list) do
    if math.type(k) ~= "integer" or k < 1 or k > 6 then
      error(what .. " has not six numbers", 0)
    end
    number(list[k], what)
  end
  return list
end

local function ratio(value, what, least)
  if number(value, what) < least or value > 100 then
    error(what .. " is outside its range", 0)
  end
  return value
end

local function told(kind, ...)
  local level, line = 2, 0
  while true do
    local at = debug.getinfo(level, "Sl")
    if not at then
      break
    end
    if at.source == "=program" then
      line = at.currentline
      break
    end
    level = level + 1
  end
  local words = {kind, tostring(line)}
  for _, value in ipairs({...}) do
    if type(value) == "table" then
      for k = 1, 12 do
        words[#words + 1] = string.format("%.17g", value[k])
      end
    else
      words[#words + 1] = type(value) == "number" and string.format("%.17g", value) or tostring(value):gsub("[\t\r\n]", " ")
    end
  end
  io.write(table.concat(words, "\t"), "\n")
end

local function api(flange)
  local users, tools = {[0] = frame_of({0, 0, 0, 0, 0, 0})}, {[0] = frame_of({0, 0, 0, 0, 0, 0})}
  users[1] = frame_of({350, 120, 75, 12, -31, 47}) -- as somebody may have left them
  tools[1] = frame_of({17, -9, 61, 25, 14, -33})
  local user, tool, cp, vel, acc = 0, 0, 0, 100, 100
  local A = {}

  local function listed(index, what)
    if math.type(index) ~= "integer" or not LISTED[index] then
      error("there is no " .. what .. " " .. tostring(index), 0)
    end
    return index
  end

  local function changed(list, what, chosen)
    return function(index, values, saved)
      if index == chosen() then
        told("act", "a frame changes that is chosen, of which the manual says nothing")
      end
      list[listed(index, what)] = frame_of(six(values, "a frame"))
      if index == 0 or saved ~= nil and saved ~= 0 then
        told("act", "a frame that stays, or another than the program's")
      end
    end
  end

  A.SetUser, A.SetTool = changed(users, "user frame", function() return user end), changed(tools, "tool", function() return tool end)
  function A.User(index) user = listed(index, "user frame") end
  function A.Tool(index) tool = listed(index, "tool") end
  function A.CP(value) cp = ratio(value, "CP", 0) end
  function A.VelL(value) vel = ratio(value, "VelL", 1) end
  function A.AccL(value) acc = ratio(value, "AccL", 1) end
  function A.GetPose(u, t)
    local u, t = listed(u or user, "user frame"), listed(t or tool, "tool")
    return {pose = pose_of(times(back(users[u]), times(flange, tools[t])))}
  end

  local function options(given)
    local o = {}
    for key, value in pairs(given or {}) do
      if not KEYS[key] then
        told("act", "an option that nobody reads: " .. tostring(key))
      end
      o[key] = value
    end
    o.user, o.tool = listed(o.user or user, "user frame"), listed(o.tool or tool, "tool")
    local part = o.v == nil and vel or ratio(o.v, "v", 1e-9)
    if o.speed == nil then
      o.speed = FASTEST * part / 100
    elseif number(o.speed, "speed") < LEAST_SPEED then
      error("speed is outside its range", 0)
    elseif o.speed ~= math.floor(o.speed) then
      told("act", "a speed that is not whole")
    end
    o.speed = math.min(o.speed, FASTEST)
    o.a = HARDEST * (o.a == nil and acc or ratio(o.a, "a", 1e-9)) / 100
    local blend = o.cp == nil and cp or ratio(o.cp, "cp", 0)
    if o.r == nil and blend > 0 then
      told("act", "a blend that hangs on speed and acceleration")
    end
    o.r = o.r or 0
    if number(o.r, "r") < 0 or o.r > WIDEST then
      error("r is outside its range", 0)
    end
    if o.stopcond ~= nil then
      told("act", "a move that an input ends")
    end
    return o
  end

  local function target(point, o)
    if type(point) ~= "table" or point.pose == nil then
      error("a point without a pose", 0)
    end
    return times(users[o.user], times(frame_of(six(point.pose, "a pose")), back(tools[o.tool])))
  end

  local function moved(to)
    flange = to
  end

  function A.MovL(point, given)
    local o = options(given)
    local to = target(point, o)
    told("line", to, o.speed, o.a, o.r)
    moved(to)
  end
  function A.MovJ(point, given)
    local o = options(given)
    local to = target(point, o)
    told("act", "a move of the joints, which goes nobody knows where")
    told("line", to, FASTEST, o.a, 0)
    moved(to)
  end
  function A.Arc(through, point, given)
    local o = options(given)
    local via, to = target(through, o), target(point, o)
    told("arc", via, to, o.speed, o.a, o.r)
    moved(to)
  end
  function A.Wait(ms)
    if math.type(ms) ~= "integer" then
      error("a wait that is no whole number", 0)
    end
    if ms > 2147483647 then
      error("a wait that is too long", 0)
    end
    told("wait", math.max(ms, 0) / 1000)
  end
  function A.Pause() told("stop") end
  function A.print(value) told("says", value) end
  function A.Halt()
    told("act", "halts")
    error("halted", 0)
  end
  A.Print, A.Log = A.print, A.print
  for _, name in ipairs({"DO", "ToolDO", "SpeedFactor", "VelJ", "AccJ", "SetPayload", "SetCollisionLevel", "Sync"}) do
    A[name] = function() told("act", name) end
  end
  return A
end

local text = io.read("a")
for k = 1, #arg do
  io.write("start\t", k, "\n")
  local place = {}
  for value in arg[k]:gmatch("[^,]+") do
    place[#place + 1] = tonumber(value)
  end
  local chunk, why = load(text, "=program", "t", api(frame_of(place)))
  if chunk then
    local run = coroutine.create(chunk)
    debug.sethook(run, function() error("it goes on and on", 0) end, "", STEPS)
    local ended
    ended, why = coroutine.resume(run)
    why = not ended and why
  end
  if why then
    io.write("refused\t0\t", (tostring(why):gsub("[\t\r\n]", " ")), "\n")
  end
end
