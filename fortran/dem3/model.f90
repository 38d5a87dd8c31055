!> A model of discrete elements in space, advanced by leap-frog steps: contact search, forces, motion, energy.
module dem3_model
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_clock, only : begin_step, end_step
   use dem_energy, only : energy_terms
   use dem_joint, only : joint_law
   use dem_loading, only : move_rate
   use dem_jointed, only : jointed_model
   use dem_ties, only : add_tie_stiffness, stretch_ties, tie_dash_loss, tie_energy, tie_loss, trace_ties
   use dem3_bodies, only : body, body_set, cross, load_moment, load_potential, place_part, spin_of, turn_freely
   use dem3_dowels, only : act_dowel, dowel, dowel_energy
   use dem3_law, only : apply_pair_law, bond_points, contact_pair, contact_point, drop_points, elastic_energy, &
      find_points
   use dem3_patch, only : measure_feature
   use, intrinsic :: iso_c_binding, only : c_int, c_int64_t
   implicit none
   private
   public :: solid_model, set_distances, search_pairs, set_mortar, colour_pairs, advance_model, critical_step, &
      energy_now, prepare_step, predict_velocity, pull_ties, move_body, look_anew

   type, extends(jointed_model) :: solid_model
      type(body_set) :: set
      type(contact_pair), allocatable :: pair(:)
      integer :: pairs = 0
      integer, allocatable :: sweep(:)                !! the pairs by colours
      integer, allocatable :: colour_first(:)         !! first of each colour in the sweep; then what has none
      integer :: colours = 0
      integer, allocatable :: law_of(:, :)            !! (3, joints): two bodies, the lower first, law; ascending
      type(dowel), allocatable :: dowels(:)
      real(wp) :: way(3) = [1.0_wp, 0.0_wp, 0.0_wp]   !! of the horizontal ground motion
      real(wp) :: gravity(3) = 0.0_wp                 !! [m/s^2]
      real(wp) :: pull(3) = 0.0_wp                    !! body force of the last step [m/s^2]
      real(wp) :: pull_before(3) = 0.0_wp
      real(wp) :: skin = 0.0_wp                       !! parts nearer than this are pairs [m]
      real(wp) :: reach = 0.0_wp                      !! a body that has moved farther makes them stale [m]
      real(wp) :: margin = 0.0_wp                     !! features nearer than this are points of a pair [m]
      real(wp) :: far = 0.0_wp                        !! bodies that have moved farther apart find them anew [m]
      real(wp) :: wander = 0.0_wp                     !! a body that has moved farther is checked for that [m]
      real(wp) :: lost(2) = 0.0_wp                    !! by friction and dashpots of pairs that are no more [J]
      real(wp), allocatable :: joint_loss(:, :)       !! (2, joints) their part of that, by joints of law_of [J]
      real(wp) :: support_work = 0.0_wp               !! of them [J]
      ! Contacts without springs, see dem3_moreau
      type(body), allocatable :: ahead(:)             !! (bodies) where the old velocities lead to
      integer, allocatable :: number(:)               !! of each contact point in the problem, 0: it cannot press
   end type solid_model

   !> Of the skin: a narrower gap is filled by mortar
   real(wp), parameter :: touching = 0.05_wp

contains

   !> Pairs of parts of different bodies whose boxes come nearer than the skin, by their numbers; contacts go on
   subroutine search_pairs(model, status)
      type(solid_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      type(contact_pair), allocatable :: found(:)
      type(contact_point), allocatable :: points(:)
      real(wp), allocatable :: low(:, :), high(:, :)
      real(wp) :: extent(3)
      integer, allocatable :: order(:), work(:)
      integer :: i, j, k, n, count, failed, room, axis, old

      do k = 1, size(model%set%parts)
         call place_part(model%set, k)
      end do
      n = size(model%set%parts)
      allocate (low(3, n), high(3, n), order(n), work(n), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      do i = 1, n
         associate (one => model%set%parts(i))
            low(:, i) = minval(model%set%here(:, one%vertex_first:one%vertex_last), dim=2)
            high(:, i) = maxval(model%set%here(:, one%vertex_first:one%vertex_last), dim=2)
         end associate
      end do
      do axis = 1, 3
         extent(axis) = maxval(high(axis, :)) - minval(low(axis, :))
      end do
      axis = maxloc(extent, dim=1)
      call sort_values(low(axis, :), work, order)
      do room = 1, 2   ! count, then fill
         count = 0
         do k = 1, n
            i = order(k)
            do j = k + 1, n
               if (low(axis, order(j)) > high(axis, i) + model%skin) exit
               associate (other => order(j))
                  if (model%set%parts(i)%owner == model%set%parts(other)%owner) cycle
                  if (model%set%item(model%set%parts(i)%owner)%fixed &
                     .and. model%set%item(model%set%parts(other)%owner)%fixed) cycle
                  if (any(low(:, i) > high(:, other) + model%skin)) cycle
                  if (any(low(:, other) > high(:, i) + model%skin)) cycle
                  count = count + 1
                  if (room == 2) found(count)%part = [min(i, other), max(i, other)]
               end associate
            end do
         end do
         if (room == 2) exit
         allocate (found(count), stat=failed)
         status = merge(status_ok, status_out_of_memory, failed == 0)
         if (failed /= 0) return
      end do
      call by_number(found, status)
      if (status /= status_ok) return
      old = 1
      do k = 1, count
         do while (old <= model%pairs)
            if (.not. before(model%pair(old)%part, found(k)%part)) exit
            call drop_pair(model, old)
            old = old + 1
         end do
         if (old <= model%pairs) then
            if (all(model%pair(old)%part == found(k)%part)) then
               ! its points are handed over: copies of them may lack memory
               call move_alloc(model%pair(old)%point, points)
               if (allocated(model%pair(old)%room)) deallocate (model%pair(old)%room)
               found(k) = model%pair(old)
               call move_alloc(points, found(k)%point)
               old = old + 1
               cycle
            end if
         end if
         found(k)%joint = joint_between(model, model%set%parts(found(k)%part(1))%owner, &
            model%set%parts(found(k)%part(2))%owner)
         if (found(k)%joint > 0) found(k)%law = model%law_of(3, found(k)%joint)
      end do
      do old = old, model%pairs
         call drop_pair(model, old)
      end do
      call move_alloc(found, model%pair)
      model%pairs = count
      do k = 1, size(model%set%item)
         model%set%item(k)%seen = model%set%item(k)%x
         model%set%item(k)%seen_turn = model%set%item(k)%turn
      end do
      model%stale = .false.
      call colour_pairs(model, status)
   end subroutine search_pairs

   !> Mortar binds what touches at the start
   subroutine set_mortar(model)
      type(solid_model), intent(inout) :: model
      integer :: k
      do k = 1, model%pairs
         associate (pair => model%pair(k), parts => model%set%parts)
            call find_points(model%law(pair%law), model%set, model%far, model%margin, pair)
            call bond_points(model%law(pair%law), touching * model%skin, model%set%item(parts(pair%part(1))%owner), &
               model%set%item(parts(pair%part(2))%owner), pair)
         end associate
      end do
   end subroutine set_mortar

   !> A pair goes: what it lost is kept
   subroutine drop_pair(model, number)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: number
      associate (pair => model%pair(number))
         call drop_points(model%law(pair%law), pair)
         model%lost = model%lost + [pair%friction_loss, pair%damping_loss]
         if (pair%joint > 0) model%joint_loss(:, pair%joint) = model%joint_loss(:, pair%joint) &
            + [pair%friction_loss, pair%damping_loss]
         model%support_work = model%support_work + pair%support_work
      end associate
   end subroutine drop_pair

   !> How near is near, from the size of the smallest part
   subroutine set_distances(model)
      type(solid_model), intent(inout) :: model
      model%wander = 0.001_wp * model%set%size
      model%far = 0.001_wp * model%set%size
      model%margin = 0.01_wp * model%set%size     ! more than far and twice wander
      model%reach = 0.02_wp * model%set%size
      model%skin = 0.08_wp * model%set%size       ! more than the margin, twice reach and twice wander
   end subroutine set_distances

   !> Colours of the pairs: two of one colour have no mobile body in common, so that they may act at once
   subroutine colour_pairs(model, status)
      type(solid_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      integer, parameter :: most = 62
      integer(c_int64_t), allocatable :: used(:)
      integer(c_int64_t) :: bits
      integer, allocatable :: of(:)
      integer :: count(most + 1), k, c, side, who, failed
      if (allocated(model%sweep)) deallocate (model%sweep)
      if (allocated(model%colour_first)) deallocate (model%colour_first)
      allocate (model%sweep(model%pairs), of(model%pairs), model%colour_first(most + 2), &
         used(size(model%set%item)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      used = 0
      count = 0
      do k = 1, model%pairs
         bits = 0
         do side = 1, 2
            who = model%set%parts(model%pair(k)%part(side))%owner
            if (.not. model%set%item(who)%fixed) bits = ior(bits, used(who))
         end do
         c = 0
         do while (c < most .and. btest(bits, c))
            c = c + 1
         end do
         of(k) = c + 1
         count(c + 1) = count(c + 1) + 1
         if (c == most) cycle
         do side = 1, 2
            who = model%set%parts(model%pair(k)%part(side))%owner
            used(who) = ibset(used(who), c)
         end do
      end do
      model%colour_first(1) = 1
      model%colours = 0
      do c = 1, most + 1
         model%colour_first(c + 1) = model%colour_first(c) + count(c)
         if (c <= most .and. count(c) > 0) model%colours = c
      end do
      count = model%colour_first(1:most + 1)
      do k = 1, model%pairs
         model%sweep(count(of(k))) = k
         count(of(k)) = count(of(k)) + 1
      end do
   end subroutine colour_pairs

   !> The law of a pair of bodies
   pure function joint_between(model, one, two) result(joint)
      type(solid_model), intent(in) :: model
      integer, intent(in) :: one
      integer, intent(in) :: two
      integer :: joint
      integer :: low, high, middle, wanted(2)
      joint = 0
      if (.not. allocated(model%law_of)) return
      wanted = [min(one, two), max(one, two)]
      low = 1
      high = size(model%law_of, 2)
      do while (low <= high)
         middle = (low + high) / 2
         if (all(model%law_of(1:2, middle) == wanted)) then
            joint = middle
            return
         end if
         if (before(model%law_of(1:2, middle), wanted)) then
            low = middle + 1
         else
            high = middle - 1
         end if
      end do
   end function joint_between

   !> Whether a pair of numbers comes before another
   pure function before(one, two) result(earlier)
      integer, intent(in) :: one(2)
      integer, intent(in) :: two(2)
      logical :: earlier
      earlier = one(1) < two(1) .or. (one(1) == two(1) .and. one(2) < two(2))
   end function before

   !> Order of values, by merging
   pure subroutine sort_values(value, work, order)
      real(wp), intent(in) :: value(:)
      integer, intent(out) :: work(:)         !! as long as the values
      integer, intent(out) :: order(:)
      integer :: width, n, i, a, b, k, last_a, last_b
      n = size(value)
      do i = 1, n
         order(i) = i
      end do
      width = 1
      do while (width < n)
         do i = 1, n, 2 * width
            a = i
            last_a = min(i + width - 1, n)
            b = last_a + 1
            last_b = min(i + 2 * width - 1, n)
            do k = i, last_b
               if (b > last_b) then
                  work(k) = order(a)
                  a = a + 1
               else if (a > last_a) then
                  work(k) = order(b)
                  b = b + 1
               else if (value(order(a)) <= value(order(b))) then
                  work(k) = order(a)
                  a = a + 1
               else
                  work(k) = order(b)
                  b = b + 1
               end if
            end do
         end do
         order = work
         width = 2 * width
      end do
   end subroutine sort_values

   !> Pairs by their numbers
   pure subroutine by_number(found, status)
      type(contact_pair), intent(inout) :: found(:)
      integer(c_int), intent(out) :: status   !! status_out_of_memory, else ok
      real(wp), allocatable :: value(:)
      integer, allocatable :: order(:), work(:), parts(:, :)
      integer :: k, failed
      allocate (value(size(found)), order(size(found)), work(size(found)), parts(2, size(found)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      do k = 1, size(found)
         parts(:, k) = found(k)%part
         value(k) = real(found(k)%part(1), wp) * 1.0e7_wp + found(k)%part(2)
      end do
      call sort_values(value, work, order)
      do k = 1, size(found)
         found(k)%part = parts(:, order(k))
      end do
   end subroutine by_number

   !> Up to `count` steps; returns early where near pairs must be searched again
   subroutine advance_model(model, count, threads)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer :: n, k, c

      if (threads > 1) then
         call advance_threads(model, count, threads)
         return
      end if
      do n = 1, count
         call prepare_step(model)
         do k = 1, size(model%set%item)
            call predict_velocity(model, model%set%item(k))
         end do
         do c = 1, model%pairs
            call act_pair(model, model%pair(model%sweep(c)))
         end do
         call bear_on_dowels(model)
         call pull_ties(model)
         do k = 1, size(model%set%item)
            call move_body(model, model%set%item(k), model%stale)
         end do
         call end_step(model%model_clock)
         if (model%stale) return
      end do
   end subroutine advance_model

   !> The same steps shared among threads: pairs of one colour touch no common mobile body
   subroutine advance_threads(model, count, threads)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer :: n, k, c
      logical :: stale

      stale = .false.
      !$omp parallel default(none) num_threads(threads) shared(model, count, stale) private(n, k, c)
      do n = 1, count
         !$omp single
         call prepare_step(model)
         stale = .false.
         !$omp end single
         !$omp do schedule(static)
         do k = 1, size(model%set%item)
            call predict_velocity(model, model%set%item(k))
         end do
         !$omp end do
         do c = 1, model%colours
            !$omp do schedule(static)
            do k = model%colour_first(c), model%colour_first(c + 1) - 1
               call act_pair(model, model%pair(model%sweep(k)))
            end do
            !$omp end do
         end do
         !$omp single
         do k = model%colour_first(model%colours + 1), model%pairs
            call act_pair(model, model%pair(model%sweep(k)))
         end do
         call bear_on_dowels(model)
         call pull_ties(model)
         !$omp end single
         !$omp do schedule(static) reduction(.or. : stale)
         do k = 1, size(model%set%item)
            call move_body(model, model%set%item(k), stale)
         end do
         !$omp end do
         !$omp single
         model%stale = stale
         call end_step(model%model_clock)
         !$omp end single
         if (model%stale) exit
      end do
      !$omp end parallel
   end subroutine advance_threads

   !> Geometry, where it must be looked at anew, and law of one pair
   pure subroutine act_pair(model, pair)
      type(solid_model), intent(inout) :: model
      type(contact_pair), intent(inout) :: pair
      associate (a => model%set%item(model%set%parts(pair%part(1))%owner), &
                 b => model%set%item(model%set%parts(pair%part(2))%owner))
         call look_anew(model, pair)
         if (pair%points > 0) call apply_pair_law(model%law(pair%law), model%kick, model%drift, a, b, pair)
      end associate
   end subroutine act_pair

   !> Forces of the dowels, one after the other: they are few
   subroutine bear_on_dowels(model)
      type(solid_model), intent(inout) :: model
      integer :: k
      do k = 1, size(model%dowels)
         associate (one => model%dowels(k))
            call act_dowel(model%kick, model%drift, model%set%item(one%body(1)), model%set%item(one%body(2)), one)
         end associate
      end do
   end subroutine bear_on_dowels

   !> Forces of the ties, added to the bodies: they are few. The ground and the supports rest
   pure subroutine pull_ties(model)
      type(solid_model), intent(inout) :: model
      integer :: k
      if (size(model%ties%item) == 0) return
      call place_anchors(model)
      call stretch_ties(model%ties, merge(model%drift, 0.0_wp, model%shaking .and. .not. model%quasi_static))
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            if (one%body == 0) cycle
            associate (b => model%set%item(one%body))
               if (b%fixed) cycle
               b%force = b%force + one%force
               b%moment = b%moment + cross(one%at - b%x, one%force)
            end associate
         end associate
      end do
   end subroutine pull_ties

   !> Where the anchors of the ties are
   pure subroutine place_anchors(model)
      type(solid_model), intent(inout) :: model
      integer :: k
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            one%at = one%place
            if (one%body > 0) one%at = model%set%item(one%body)%x &
               + matmul(model%set%item(one%body)%turn, one%place)
         end associate
      end do
   end subroutine place_anchors

   !> Geometry of a pair, where a body has moved far enough
   pure subroutine look_anew(model, pair)
      type(solid_model), intent(in) :: model
      type(contact_pair), intent(inout) :: pair
      associate (a => model%set%item(model%set%parts(pair%part(1))%owner), &
                 b => model%set%item(model%set%parts(pair%part(2))%owner))
         if (pair%marks(1) == a%marks .and. pair%marks(2) == b%marks) return
      end associate
      call find_points(model%law(pair%law), model%set, model%far, model%margin, pair)
   end subroutine look_anew

   !> Body force and velocity of the ground in this step
   subroutine prepare_step(model)
      type(solid_model), intent(inout) :: model
      real(wp) :: ground(3)
      call begin_step(model%model_clock, ground)
      model%pull_before = model%pull
      model%pull = model%gravity - ground(1) * model%way - [0.0_wp, 0.0_wp, ground(2)] &
         - ground(3) * [-model%way(2), model%way(1), 0.0_wp]
      call prescribe_supports(model)
   end subroutine prepare_step

   !> Velocities of supports in the coming half step
   pure subroutine prescribe_supports(model)
      type(solid_model), intent(inout) :: model
      integer :: k
      if (.not. allocated(model%load%move)) return
      do k = 1, size(model%load%move)
         model%set%item(model%load%move(k)%body)%p = 0.0_wp
      end do
      if (.not. model%shaking .or. model%waits > 0) return
      do k = 1, size(model%load%move)
         associate (b => model%set%item(model%load%move(k)%body))
            b%p = b%p + move_rate(model%load%move(k), model%t + 0.5_wp * model%step)
         end associate
      end do
   end subroutine prescribe_supports

   !> Velocity that follows from the forces of the last step; of the next ones it leaves the constant loads
   pure subroutine predict_velocity(model, b)
      type(solid_model), intent(in) :: model
      type(body), intent(inout) :: b
      if (b%fixed) return
      b%spin = spin_of(b, b%swing)
      b%p = b%v + model%kick * (b%force * b%inverse_mass + model%pull)
      b%pspin = spin_of(b, b%swing + model%kick * b%moment)
      ! Work of the ground's part of the body force; gravity has a potential.
      b%work = b%work + 0.5_wp * model%drift * b%mass &
         * dot_product(model%pull + model%pull_before - 2.0_wp * model%gravity, b%v)
      b%force = b%load
      b%moment = load_moment(b)
      b%touched = .false.
   end subroutine predict_velocity

   !> Velocity and place after the step
   pure subroutine move_body(model, b, stale)
      type(solid_model), intent(in) :: model
      type(body), intent(inout) :: b
      logical, intent(inout) :: stale
      if (b%fixed) then
         if (.not. any(abs(b%v) + abs(b%p) > 0.0_wp)) return
         b%v = b%p
         b%x = b%x + model%step * b%v
      else
         b%v = b%v + model%kick * (b%force * b%inverse_mass + model%pull)
         b%swing = b%swing + model%kick * b%moment
         b%x = b%x + model%step * b%v
         call turn_freely(b, model%step)
         if (.not. b%touched) then
            b%airborne = b%airborne + model%step
            if (b%touching) b%bounces = b%bounces + 1
         end if
         b%touching = b%touched
      end if
      if (norm2(b%x - b%marked) + b%radius * norm2(b%turn - b%marked_turn) < model%wander) return
      b%marks = b%marks + 1
      b%marked = b%x
      b%marked_turn = b%turn
      if (norm2(b%x - b%seen) + b%radius * norm2(b%turn - b%seen_turn) > model%reach) stale = .true.
   end subroutine move_body

   !> A step that is stable for all contacts that may close: 2 / omega, with omega^2 above the greatest eigenvalue of
   !> any body on its springs, twice as stiff where the neighbour moves too [s]
   subroutine critical_step(model, step, status)
      type(solid_model), intent(inout) :: model
      real(wp), intent(out) :: step          !! [s]
      integer(c_int), intent(out) :: status
      real(wp), allocatable :: stiffness(:, :, :), square(:)
      real(wp) :: greatest, share, normal(3), gap, at(3), area
      type(joint_law) :: spring
      integer :: k, i, side, who, failed
      step = 0.0_wp
      allocate (stiffness(6, 6, size(model%set%item)), square(size(model%set%item)), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      stiffness = 0.0_wp
      do k = 1, merge(0, model%pairs, model%rigid%setting%used)
         associate (pair => model%pair(k), parts => model%set%parts)
            call find_points(model%law(pair%law), model%set, model%far, model%margin, pair)
            share = merge(1.0_wp, 2.0_wp, model%set%item(parts(pair%part(1))%owner)%fixed &
               .or. model%set%item(parts(pair%part(2))%owner)%fixed)
            do i = 1, pair%points
               call measure_feature(pair%point(i)%what, model%set%item(parts(pair%part(1))%owner), &
                  model%set%item(parts(pair%part(2))%owner), normal, gap, at)
               do side = 1, 2
                  who = parts(pair%part(side))%owner
                  call add_spring(model%law(pair%law), share * pair%point(i)%what%area, normal, at, &
                     model%set%item(who), &
                     stiffness(:, :, who))
               end do
            end do
         end associate
      end do
      ! What touches nothing yet will land, on its largest face at the worst.
      do k = 1, merge(0, size(model%set%parts), model%rigid%setting%used)
         who = model%set%parts(k)%owner
         associate (b => model%set%item(who), one => model%set%parts(k))
            if (b%fixed .or. any(abs(stiffness(:, :, who)) > 0.0_wp)) cycle
            area = maxval(model%set%area(one%face_first:one%face_last))
            call add_spring(model%law(1), 2.0_wp * area, [0.0_wp, 0.0_wp, 1.0_wp], b%x + b%radius * b%turn(:, 1), b, &
               stiffness(:, :, who))
         end associate
      end do
      do k = 1, merge(0, size(model%dowels), model%rigid%setting%used)
         associate (one => model%dowels(k))
            share = merge(1.0_wp, 2.0_wp, any(model%set%item(one%body)%fixed))
            spring = joint_law(normal_stiffness=0.0_wp, shear_stiffness=one%stiffness)
            normal = matmul(model%set%item(one%body(1))%turn, one%axis)
            at = model%set%item(one%body(2))%x + matmul(model%set%item(one%body(2))%turn, one%place(:, 2))
            do side = 1, 2
               call add_spring(spring, share, normal, at, model%set%item(one%body(side)), stiffness(:, :, &
                  one%body(side)))
            end do
         end associate
      end do
      call stiffen_by_ties(model, square)
      greatest = 0.0_wp
      do k = 1, size(model%set%item)
         if (.not. model%set%item(k)%fixed) greatest = max(greatest, square(k) + above_eigenvalues(stiffness(:, :, k)))
      end do
      step = 2.0_wp / sqrt(max(greatest, tiny(1.0_wp)))
   end subroutine critical_step

   !> What the ties add to the squares of the frequencies of the bodies, see add_tie_stiffness
   pure subroutine stiffen_by_ties(model, square)
      type(solid_model), intent(inout) :: model
      real(wp), intent(out) :: square(:)     !! (bodies) [1/s^2]
      real(wp) :: pull(3), swing(3)
      integer :: k
      square = 0.0_wp
      if (size(model%ties%item) == 0) return
      call place_anchors(model)
      call trace_ties(model%ties)
      do k = 1, size(model%ties%anchor)
         associate (one => model%ties%anchor(k))
            one%answer = 0.0_wp
            one%mobility = 0.0_wp
            if (one%body == 0) cycle
            associate (b => model%set%item(one%body))
               if (b%fixed) cycle
               pull = one%share * model%ties%pull(:, one%point)
               swing = matmul(cross(one%at - b%x, pull), b%turn)
               one%answer = sqrt(b%inverse_mass * dot_product(pull, pull) + sum(swing**2 / b%inertia))
               one%mobility = b%inverse_mass + sum((one%at - b%x)**2) / minval(b%inertia)
            end associate
         end associate
      end do
      call add_tie_stiffness(model%ties, square)
   end subroutine stiffen_by_ties

   !> Add the springs at a point to the 6 x 6 stiffness of a body, scaled by its masses, in its own axes
   pure subroutine add_spring(law, area, normal, at, b, stiffness)
      type(joint_law), intent(in) :: law
      real(wp), intent(in) :: area           !! [m^2]
      real(wp), intent(in) :: normal(3)
      real(wp), intent(in) :: at(3)          !! [m]
      type(body), intent(in) :: b
      real(wp), intent(inout) :: stiffness(6, 6)
      real(wp) :: velocity(3, 6), along(6), arm(3), unit(3)
      integer :: k, i, j
      if (b%fixed) return
      arm = matmul(at - b%x, b%turn)
      along(1:3) = matmul(normal, b%turn)
      do k = 1, 3
         unit = 0.0_wp
         unit(k) = 1.0_wp
         velocity(:, k) = unit * sqrt(b%inverse_mass)
         velocity(:, k + 3) = cross(unit, arm) / sqrt(b%inertia(k))
      end do
      along = matmul(along(1:3), velocity)
      do j = 1, 6
         do i = 1, 6
            stiffness(i, j) = stiffness(i, j) &
               + area * (law%shear_stiffness * dot_product(velocity(:, i), velocity(:, j)) &
               + (law%normal_stiffness - law%shear_stiffness) * along(i) * along(j))
         end do
      end do
   end subroutine add_spring

   !> A bound of the eigenvalues of a symmetric matrix, at most 6 % above the greatest: the 32nd root of the sum of
   !> their 32nd powers
   pure function above_eigenvalues(matrix) result(bound)
      real(wp), intent(in) :: matrix(6, 6)
      real(wp) :: bound
      real(wp) :: power(6, 6), size, scale
      integer :: k
      bound = 0.0_wp
      size = maxval(abs(matrix))
      if (.not. size > 0.0_wp) return
      power = matrix / size
      scale = 0.0_wp                         ! logarithm of what was taken out
      do k = 1, 4
         power = matmul(power, power)
         bound = maxval(abs(power))
         power = power / bound
         scale = 2.0_wp * scale + log(bound)
      end do
      ! |A^16| = root of the sum of the 32nd powers.
      bound = size * exp((scale + log(norm2(power))) / 16.0_wp)
   end function above_eigenvalues

   !> Energy balance at the time of the last forces: leap-frog keeps m v(n-1/2) v(n+1/2) / 2 plus the energy of linear springs
   pure function energy_now(model) result(now)
      type(solid_model), intent(in) :: model
      type(energy_terms) :: now
      real(wp) :: v(3), swing(3), span
      type(body) :: b
      integer :: k
      span = max(model%kick, model%step)
      do k = 1, size(model%set%item)
         if (model%set%item(k)%fixed) cycle
         b = model%set%item(k)
         v = b%v - span * (b%force * b%inverse_mass + model%pull)
         swing = b%swing - span * b%moment
         ! The attitude of the forces: a free turn back.
         call turn_freely(b, -model%drift)
         now%leapfrog = now%leapfrog + 0.5_wp * (b%mass * dot_product(b%v, v) + dot_product(b%swing, spin_of(b, swing)))
         now%kinetic = now%kinetic + 0.125_wp * (b%mass * dot_product(b%v + v, b%v + v) &
            + dot_product(b%swing + swing, spin_of(b, b%swing + swing)))
         now%potential = now%potential - b%mass * dot_product(model%gravity, b%x - model%drift * b%v - b%rest) &
            + load_potential(b, b%x - model%drift * b%v)
         now%work = now%work + b%work
      end do
      now%friction = model%lost(1) + tie_loss(model%ties)
      now%damping = model%lost(2) + tie_dash_loss(model%ties)
      now%elastic = tie_energy(model%ties)
      now%work = now%work + model%support_work
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            now%elastic = now%elastic + elastic_energy(model%law(pair%law), pair)
            now%friction = now%friction + pair%friction_loss
            now%damping = now%damping + pair%damping_loss
            now%work = now%work + pair%support_work
         end associate
      end do
      do k = 1, size(model%dowels)
         associate (one => model%dowels(k))
            if (.not. model%rigid%setting%used) now%elastic = now%elastic + dowel_energy(one)
            now%friction = now%friction + one%friction_loss
            now%damping = now%damping + one%damping_loss
            now%work = now%work + one%support_work
         end associate
      end do
   end function energy_now

end module dem3_model
