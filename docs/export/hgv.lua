-- A truck profile for OSRM: its own car profile, reading the tags that speak of heavy goods vehicles first.
-- Put it beside car.lua and its lib/ folder. Dimensions are those of the vehicle that permits were exported for.

local car = require('car')

-- Roads on which the vehicle needs the oncoming lane. A request with exclude=oncoming keeps off them. Turns may still need it.
local ONCOMING_LANE = 'oncoming'

local function setup()
  local profile = car.setup()
  profile.access_tags_hierarchy = Sequence { 'hgv', 'motor_vehicle', 'vehicle', 'access' }
  profile.restrictions = Sequence { 'hgv', 'motor_vehicle', 'vehicle' }
  table.insert(profile.classes, ONCOMING_LANE)
  table.insert(profile.excludable, Set { ONCOMING_LANE })
  profile.vehicle_height = 4.0 -- m
  profile.vehicle_width = 2.55 -- m
  profile.vehicle_length = 16.5 -- m
  profile.vehicle_weight = 40000 -- kg
  profile.vehicle_max_speed = 80 -- km/h
  return profile
end

-- Makes roads dearer on which the vehicle needs more than its own lane. Their time stays the same.
local function process_way(profile, way, result, relations)
  car.process_way(profile, way, result, relations)
  local cost = { tonumber(way:get_value_by_key('netcert:cost:forward')), tonumber(way:get_value_by_key('netcert:cost:backward')) }
  if cost[1] then
    result.forward_rate = result.forward_rate / cost[1]
  end
  if cost[2] then
    result.backward_rate = result.backward_rate / cost[2]
  end
  if way:get_value_by_key('netcert:uses:forward') == 'carriageway' then
    result.forward_classes[ONCOMING_LANE] = true
  end
  if way:get_value_by_key('netcert:uses:backward') == 'carriageway' then
    result.backward_classes[ONCOMING_LANE] = true
  end
end

return {
  setup = setup,
  process_way = process_way,
  process_node = car.process_node,
  process_turn = car.process_turn,
}
