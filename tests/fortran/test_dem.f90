!> Discrete elements: bodies from polygons, where two blocks touch, and the contact law in each of its states.
program test_dem
   use common_kinds, only : wp
   use common_status, only : status_ok, status_bad_geometry, status_invalid_argument
   use dem_bodies, only : body, body_set, body_set_new, body_turn
   use dem_contacts, only : choose_edges, contact_pair, contact_set, measure_overlap, measure_springs, overlap
   use dem_joint, only : joint_law
   use dem_law, only : apply_pair_law, elastic_energy
   use dem_model, only : block_model
   use dem_moreau, only : number_unknowns, solve_contacts
   use dem_rigid, only : rigid_setting, set_rigid
   use dem_search, only : search_pairs
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none (type, external)
   real(wp), parameter :: box(2, 4) = reshape([0.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 4])
   real(wp), parameter :: mass = 3000.0_wp, inertia = mass * 5.0_wp / 12.0_wp
   type(joint_law), parameter :: dry = joint_law(2.0e8_wp, 1.0e8_wp, 0.5_wp)
   integer(c_int) :: status

   call bodies()
   call touching()
   call normal_force()
   call friction()
   call dashpots()
   call mortar()
   call other_edges()
   call other_edges_on_rigid_contacts()
   print '(a)', 'dem: all right'

contains

   !> The box on a floor (body 1: the box, body 2: the floor below it)
   subroutine box_on_floor(set, left)
      type(body_set), intent(out) :: set
      real(wp), intent(in), optional :: left     !! end of the floor [m], 2.5 m from the other one
      real(wp) :: floor(2, 4)
      floor(1, :) = 10.0_wp * box(1, :) - 9.0_wp
      if (present(left)) floor(1, :) = left + 1.25_wp * box(1, :)
      floor(2, :) = box(2, :) - 1.0_wp
      call body_set_new(reshape([1.0_wp, 0.5_wp, 1.0_wp, -0.5_wp], [2, 2]), [mass, 0.0_wp], [inertia, 0.0_wp], &
         [1_c_int, 2_c_int], [1_c_int, 5_c_int, 9_c_int], reshape([box, floor], [2, 8]), &
         spread(1_c_int, 1, 8), set, status)
      if (status /= status_ok) error stop 'a box on a floor is refused'
   end subroutine box_on_floor

   subroutine bodies()
      type(body_set) :: set
      integer(c_int), parameter :: outer(4) = 1_c_int
      call box_on_floor(set)
      if (abs(set%item(1)%radius - sqrt(1.25_wp)) > 1e-15_wp) error stop 'radius'
      if (abs(set%size - sqrt(2.0_wp)) > 1e-14_wp) error stop 'size of the smallest mobile part'
      if (.not. set%item(2)%fixed .or. set%item(2)%inverse_mass > 0.0_wp) error stop 'a support that moves'
      if (abs(set%edges(2)%tx) > 0.0_wp .or. abs(set%edges(2)%ty - 1.0_wp) > 0.0_wp) error stop 'a tangent'
      if (set%edges(4)%next /= 1) error stop 'a part does not close'
      call body_set_new(reshape([1.0_wp, 0.5_wp], [2, 1]), [mass], [inertia], [1_c_int], [1_c_int, 5_c_int], &
         box(:, [4, 3, 2, 1]), outer, set, status)
      if (status /= status_bad_geometry) error stop 'a clockwise part is taken'
      call body_set_new(reshape([1.0_wp, 0.5_wp], [2, 1]), [mass], [inertia], [2_c_int], [1_c_int, 5_c_int], box, &
         outer, set, status)
      if (status /= status_invalid_argument) error stop 'a part of nobody is taken'
      call body_set_new(reshape([1.0_wp, 0.5_wp], [2, 1]), [mass], [inertia], [1_c_int], [1_c_int, 9_c_int], box, &
         outer, set, status)
      if (status /= status_invalid_argument) error stop 'vertices that are not there are taken'
   end subroutine bodies

   !> One pair; gaps follow the box as it rises and as it turns about a corner
   subroutine touching()
      real(wp), parameter :: rise = 1.0e-3_wp, turn = 2.0e-3_wp
      type(body_set) :: set
      type(contact_set) :: contacts
      type(overlap) :: now
      call box_on_floor(set)
      call near_floor(set, contacts)
      associate (pair => contacts%pair(1), a => set%item(contacts%pair(1)%bodies(1)), &
                 b => set%item(contacts%pair(1)%bodies(2)))
         if (pair%law /= 1) error stop 'the law of a joint without an entry'
         call measure_overlap(pair, a, b, now)
         if (abs(now%width - 2.0_wp) > 1e-14_wp .or. maxval(abs(now%gap)) > 1e-14_wp) error stop 'at rest'
         if (abs(minval(now%x)) > 1e-14_wp .or. abs(maxval(now%x) - 2.0_wp) > 1e-14_wp) error stop 'points at the ends'
         set%item(1)%y = 0.5_wp + rise
         call measure_overlap(pair, a, b, now)
         if (maxval(abs(now%gap - rise)) > 1e-14_wp) error stop 'risen'
         ! about the corner (2, 0): clockwise, so that the other corner lifts by 2 sin(turn)
         set%item(1)%angle = -turn
         call body_turn(set%item(1))
         set%item(1)%x = 2.0_wp - cos(turn) + 0.5_wp * sin(turn)
         set%item(1)%y = sin(turn) + 0.5_wp * cos(turn)
         call measure_overlap(pair, a, b, now)
         if (abs(minval(now%gap)) > 1e-14_wp) error stop 'the corner it turns about'
         if (abs(maxval(now%gap) - 2.0_wp * sin(turn)) > 1e-6_wp * turn) error stop 'the corner that lifts'
      end associate
   end subroutine touching

   !> The box and the floor as a pair
   subroutine near_floor(set, contacts)
      type(body_set), intent(inout) :: set
      type(contact_set), intent(out) :: contacts
      allocate (contacts%law_first(3), contacts%law_body(0), contacts%law_number(0))
      contacts%law_first = 1
      contacts%skin = 0.02_wp * set%size
      call search_pairs(set, contacts, .true., status)
      if (status /= status_ok .or. contacts%pairs /= 1) error stop 'a box and a floor make one pair'
      contacts%pair(1)%point%bonded = .false.
   end subroutine near_floor

   !> The box turned about a point below it
   subroutine turn_box(set, about, angle)
      type(body_set), intent(inout) :: set
      real(wp), intent(in) :: about              !! x of a point of its base [m]
      real(wp), intent(in) :: angle
      set%item(1)%angle = angle
      call body_turn(set%item(1))
      set%item(1)%x = about + (1.0_wp - about) * cos(angle) - 0.5_wp * sin(angle)
      set%item(1)%y = (1.0_wp - about) * sin(angle) + 0.5_wp * cos(angle)
   end subroutine turn_box

   !> Energy that springs give up as other edges meet: what they hold, less what has crushed at a constant force
   subroutine other_edges()
      real(wp), parameter :: crushed = 0.4e-3_wp
      type(body_set) :: set
      type(contact_set) :: contacts
      type(overlap) :: was, now
      real(wp) :: distance
      ! The end of the floor meets the base, where the corner beyond it did
      call box_on_floor(set, 0.5_wp)
      call near_floor(set, contacts)
      associate (pair => contacts%pair(1))
         call turn_box(set, 2.0_wp, 1.0e-3_wp)
         pair%point%meets = 0
         pair%point%closed = .true.
         pair%point%length = 1.0_wp
         pair%point%crushed = crushed
         call measure_overlap(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), was, [0, 0])
         call measure_springs(pair, set%item(pair%bodies(1)), set%item(pair%bodies(2)), now)
         call near(pair%given_up(2), 0.5_wp * (minval(was%gap)**2 - crushed**2 - minval(now%gap)**2), &
            'energy that a corner beyond the floor gives up')
      end associate
      ! The box comes to rest on its side: the corner that is up is free, with length or without
      call box_on_floor(set)
      call near_floor(set, contacts)
      associate (pair => contacts%pair(1))
         pair%point%meets = 0
         pair%point%closed = .true.
         pair%point%length = [1.0_wp, 0.0_wp]
         pair%point%spring_s = [0.0_wp, 1.0_wp]
         if (pair%bodies(2) /= 1) error stop 'the floor has the longer edge'
         call turn_box(set, 2.0_wp, -1.57_wp)
         call choose_edges(set, contacts%skin, pair, distance)
         if (maxval(pair%given_up) > 1.0e-12_wp) error stop 'springs that are free hold energy'
      end associate
   end subroutine other_edges

   !> A point on rigid contacts that meets the end of the floor keeps its force as the edges change
   subroutine other_edges_on_rigid_contacts()
      type(block_model) :: model
      real(wp) :: distance, force
      call box_on_floor(model%set, 0.5_wp)
      call near_floor(model%set, model%contacts)
      allocate (model%law(1), model%ties%item(0), model%ties%anchor(0), model%load%move(0))
      model%law = dry
      model%gravity = [0.0_wp, -10.0_wp]
      model%step = 1.0e-3_wp
      call set_rigid(model%rigid, model%model_clock, rigid_setting(used=.true.), 10.0_wp, 1.0_wp, mass)
      call number_unknowns(model, status)
      associate (pair => model%contacts%pair(1))
         pair%point%meets = 0                    ! as a change of edges left them
         call solve_contacts(model, status)
         if (status /= status_ok) error stop 'a box on the end of a floor'
         force = pair%point(2)%spring_n
         if (.not. force > 0.0_wp) error stop 'the end of the floor carries nothing'
         call turn_box(model%set, 0.5_wp, 0.3_wp)
         call choose_edges(model%set, model%contacts%skin, pair, distance)
         if (pair%bodies(2) /= 2) error stop 'the base of the box is no reference'
         if (minval(abs(pair%point%spring_n - force)) > 0.0_wp) error stop 'the force at the end of the floor is lost'
      end associate
   end subroutine other_edges_on_rigid_contacts

   !> A floor (a) and the box above it (b), two points at the ends of the joint
   subroutine scene(gap, a, b, pair, now)
      real(wp), intent(in) :: gap(2)
      type(body), intent(out) :: a
      type(body), intent(out) :: b
      type(contact_pair), intent(out) :: pair
      type(overlap), intent(out) :: now
      a%fixed = .true.
      b%x = 1.0_wp
      b%y = 0.5_wp
      b%mass = mass
      b%inertia = inertia
      b%inverse_mass = 1.0_wp / mass
      b%inverse_inertia = 1.0_wp / inertia
      pair%reference_length = 2.0_wp
      pair%incident_length = 2.0_wp
      now%tx = -1.0_wp     ! the normal (ty, -tx) points up, into the box
      now%ty = 0.0_wp
      now%x = [0.0_wp, 2.0_wp]
      now%y = 0.0_wp
      now%gap = gap
      now%width = 2.0_wp
   end subroutine scene

   !> N = kn (L/2) depth of overlap at each point; none where it gapes
   subroutine normal_force()
      real(wp), parameter :: deep = 1.0e-4_wp
      type(body) :: a, b
      type(contact_pair) :: pair
      type(overlap) :: now
      call scene([-deep, -deep], a, b, pair, now)
      call apply_pair_law(dry, 0.0_wp, 0.0_wp, now, a, b, pair)
      call near(b%fy, 2.0_wp * 2.0e8_wp * deep, 'normal force of a whole joint')
      call near(b%moment + 1.0_wp, 1.0_wp, 'moment of a whole joint')
      call near(elastic_energy(dry, pair), 0.5_wp * (2.0e8_wp * 2.0_wp) * deep**2, 'energy of the springs')
      call scene([-deep, deep], a, b, pair, now)
      call apply_pair_law(dry, 0.0_wp, 0.0_wp, now, a, b, pair)
      call near(b%fy, 2.0e8_wp * deep, 'normal force at one corner')
      call near(b%moment, -2.0e8_wp * deep, 'moment of one corner')
      if (pair%point(2)%closed) error stop 'an open point is closed'
   end subroutine normal_force

   !> The shear spring sticks below mu N and slides at it; the loss is the slip times the mean force
   subroutine friction()
      real(wp), parameter :: deep = 1.0e-4_wp, drift = 1.0e-3_wp, weight = 2.0e8_wp * deep
      type(body) :: a, b
      type(contact_pair) :: pair
      type(overlap) :: now
      real(wp) :: slip
      call scene([-deep, -deep], a, b, pair, now)
      b%vx = 0.25_wp * weight / 1.0e8_wp / drift        ! half of what it can bear
      call apply_pair_law(dry, 0.0_wp, drift, now, a, b, pair)
      call near(b%fx, -0.5_wp * weight, 'sticking')
      if (maxval(abs(pair%point%friction_loss)) > 0.0_wp) error stop 'what sticks loses energy'
      call scene([-deep, -deep], a, b, pair, now)
      slip = 2.0_wp * weight / 1.0e8_wp
      b%vx = slip / drift
      call apply_pair_law(dry, 0.0_wp, drift, now, a, b, pair)
      call near(b%fx, -0.5_wp * 2.0_wp * weight, 'sliding: mu N at both points')
      call near(pair%point(1)%friction_loss, (slip - 0.5_wp * weight / 1.0e8_wp) * 0.25_wp * weight, 'loss in sliding')
   end subroutine friction

   !> Dashpots: beta k u' without a step, less with one (backward Euler), never a pull on a dry joint
   subroutine dashpots()
      real(wp), parameter :: deep = 1.0e-4_wp, beta = 1.0e-3_wp, speed = 0.01_wp, stiff = 2.0e8_wp
      type(joint_law) :: law
      type(body) :: a, b
      type(contact_pair) :: pair
      type(overlap) :: now
      law = dry
      law%damping = beta
      call scene([-deep, -deep], a, b, pair, now)
      b%py = -speed
      call apply_pair_law(law, 0.0_wp, 0.0_wp, now, a, b, pair)
      call near(b%fy, 2.0_wp * (stiff * deep + beta * stiff * speed), 'dashpots in compression')
      call scene([-deep, -deep], a, b, pair, now)
      b%py = 2.0_wp * deep / beta
      call apply_pair_law(law, 0.0_wp, 0.0_wp, now, a, b, pair)
      call near(b%fy + 1.0_wp, 1.0_wp, 'a dashpot that would pull')
   end subroutine dashpots

   !> Mortar bears tension up to its strength, and is gone for good beyond
   subroutine mortar()
      real(wp), parameter :: open = 1.0e-5_wp
      type(joint_law) :: law
      type(body) :: a, b
      type(contact_pair) :: pair
      type(overlap) :: now
      law = dry
      law%tension = 1.5_wp * law%normal_stiffness * open
      law%cohesion = 2.0_wp * law%tension   ! or the shear criterion would end the bond first
      call scene([open, open], a, b, pair, now)
      pair%point%bonded = .true.
      call apply_pair_law(law, 0.0_wp, 0.0_wp, now, a, b, pair)
      call near(b%fy, -2.0_wp * law%normal_stiffness * open, 'mortar in tension')
      if (.not. all(pair%point%bonded)) error stop 'mortar fails below its strength'
      now%gap = 2.0_wp * open
      b%fy = 0.0_wp
      call apply_pair_law(law, 0.0_wp, 0.0_wp, now, a, b, pair)
      if (any(pair%point%bonded) .or. abs(b%fy) > 0.0_wp) error stop 'mortar torn'
      now%gap = open
      call apply_pair_law(law, 0.0_wp, 0.0_wp, now, a, b, pair)
      if (any(pair%point%bonded) .or. abs(b%fy) > 0.0_wp) error stop 'torn mortar heals'
   end subroutine mortar

   subroutine near(value, expected, what)
      real(wp), intent(in) :: value
      real(wp), intent(in) :: expected
      character(len=*), intent(in) :: what
      if (abs(value - expected) > 1e-11_wp * abs(expected)) then
         print *, value, expected
         error stop what
      end if
   end subroutine near

end program test_dem
