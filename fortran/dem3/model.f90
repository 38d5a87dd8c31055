!> A model of discrete elements in space, advanced by leap-frog steps: contact search, forces, motion, energy.
module dem3_model
   use common_kinds, only : wp
   use common_status, only : status_ok, status_out_of_memory
   use dem_loading, only : loading, mean_acceleration
   use dem3_bodies, only : body, body_set, cross, place, spin_of, turn_freely
   use dem3_law, only : act, contact_pair, elastic_energy, joint_law
   use dem3_patch, only : meet, patch
   use, intrinsic :: iso_c_binding, only : c_int
   implicit none
   private
   public :: solid_model, search, advance, critical_step, energy_terms, energy_now, energy_residual

   type :: solid_model
      type(body_set) :: set
      type(contact_pair), allocatable :: pair(:)
      integer :: pairs = 0
      type(joint_law), allocatable :: law(:)          !! the first is that of contacts that form later
      integer, allocatable :: law_of(:, :)            !! (3, joints): two bodies, the lower first, and their law
      type(loading) :: load                           !! its gravity is not used: that here is along z
      real(wp) :: way(3) = [1.0_wp, 0.0_wp, 0.0_wp]   !! of the horizontal ground motion
      real(wp) :: gravity(3) = 0.0_wp                 !! [m/s^2]
      real(wp) :: t = 0.0_wp                          !! time of the next forces [s]
      real(wp) :: step = 0.0_wp                       !! [s]
      real(wp) :: drift = 0.0_wp                      !! position step that led here; 0 at the start [s]
      real(wp) :: kick = 0.0_wp                       !! velocity step taken last [s]
      real(wp) :: pull(3) = 0.0_wp                    !! body force of the last step [m/s^2]
      real(wp) :: pull_before(3) = 0.0_wp
      real(wp) :: skin = 0.0_wp                       !! parts nearer than this are looked at [m]
      real(wp) :: lost(2) = 0.0_wp                    !! by friction and dashpots of pairs that are no more [J]
      integer :: segment = 0                          !! of the ground motion
      integer :: steps = 0
      logical :: shaking = .false.                    !! false while settling: the ground rests
      logical :: stale = .false.                      !! somebody moved far enough to look for contacts again
   end type solid_model

   type :: energy_terms
      real(wp) :: kinetic = 0.0_wp        !! [J], at the time of the forces
      real(wp) :: leapfrog = 0.0_wp       !! [J], the conserved form
      real(wp) :: potential = 0.0_wp      !! of gravity, 0 at rest [J]
      real(wp) :: elastic = 0.0_wp        !! in the springs [J]
      real(wp) :: friction = 0.0_wp       !! lost by sliding [J]
      real(wp) :: damping = 0.0_wp        !! lost in dashpots [J]
      real(wp) :: work = 0.0_wp           !! done by the ground and the supports [J]
   end type energy_terms

contains

   !> Pairs of parts of different bodies whose boxes come nearer than the skin, by their numbers; contacts go on
   subroutine search(model, status)
      type(solid_model), intent(inout) :: model
      integer(c_int), intent(out) :: status
      type(contact_pair), allocatable :: found(:)
      real(wp), allocatable :: low(:, :), high(:, :)
      integer, allocatable :: order(:)
      integer :: i, j, k, n, count, failed, room, axis, old

      n = size(model%set%parts)
      allocate (low(3, n), high(3, n), order(n), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      do i = 1, n
         associate (one => model%set%parts(i))
            low(:, i) = minval(model%set%here(:, one%vertex_first:one%vertex_last), dim=2)
            high(:, i) = maxval(model%set%here(:, one%vertex_first:one%vertex_last), dim=2)
         end associate
      end do
      axis = maxloc(maxval(high, dim=2) - minval(low, dim=2), dim=1)
      call sorted(low(axis, :), order)
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
      call by_number(found)
      old = 1
      do k = 1, count
         do while (old <= model%pairs)
            if (.not. before(model%pair(old)%part, found(k)%part)) exit
            call forget(model, old)
            old = old + 1
         end do
         if (old <= model%pairs) then
            if (all(model%pair(old)%part == found(k)%part)) then
               found(k) = model%pair(old)
               old = old + 1
               cycle
            end if
         end if
         found(k)%law = law_between(model, model%set%parts(found(k)%part(1))%owner, &
            model%set%parts(found(k)%part(2))%owner)
      end do
      do old = old, model%pairs
         call forget(model, old)
      end do
      call move_alloc(found, model%pair)
      model%pairs = count
      do k = 1, size(model%set%item)
         model%set%item(k)%seen = model%set%item(k)%x
         model%set%item(k)%seen_turn = model%set%item(k)%turn
      end do
      model%stale = .false.
   end subroutine search

   !> A pair goes: what it lost is kept
   subroutine forget(model, number)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: number
      integer :: k
      associate (pair => model%pair(number))
         model%lost = model%lost + [pair%friction_loss, pair%damping_loss]
         do k = 1, pair%points
            model%lost(1) = model%lost(1) + 0.5_wp * dot_product(pair%point(k)%spring_s, pair%point(k)%spring_s) &
               / (model%law(pair%law)%shear_stiffness * pair%point(k)%area)
         end do
      end associate
   end subroutine forget

   !> The law of a pair of bodies
   pure function law_between(model, one, two) result(law)
      type(solid_model), intent(in) :: model
      integer, intent(in) :: one
      integer, intent(in) :: two
      integer :: law
      integer :: k
      law = 1
      if (.not. allocated(model%law_of)) return
      do k = 1, size(model%law_of, 2)
         if (model%law_of(1, k) == min(one, two) .and. model%law_of(2, k) == max(one, two)) law = model%law_of(3, k)
      end do
   end function law_between

   !> Whether a pair of numbers comes before another
   pure function before(one, two) result(earlier)
      integer, intent(in) :: one(2)
      integer, intent(in) :: two(2)
      logical :: earlier
      earlier = one(1) < two(1) .or. (one(1) == two(1) .and. one(2) < two(2))
   end function before

   !> Order of values, by merging
   pure subroutine sorted(value, order)
      real(wp), intent(in) :: value(:)
      integer, intent(out) :: order(:)
      integer :: work(size(value)), width, n, i, a, b, k, last_a, last_b
      n = size(value)
      order = [(i, i = 1, n)]
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
   end subroutine sorted

   !> Pairs by their numbers
   pure subroutine by_number(found)
      type(contact_pair), intent(inout) :: found(:)
      real(wp) :: value(size(found))
      integer :: order(size(found)), parts(2, size(found)), k
      do k = 1, size(found)
         parts(:, k) = found(k)%part
         value(k) = real(found(k)%part(1), wp) * 1.0e7_wp + found(k)%part(2)
      end do
      call sorted(value, order)
      do k = 1, size(found)
         found(k)%part = parts(:, order(k))
      end do
   end subroutine by_number

   !> Up to `count` steps; returns early where the contacts must be searched again.
   !> Threads share the geometry of the pairs, which is most of the work; forces are summed in the order of the pairs,
   !> so that no bit depends on the threads.
   subroutine advance(model, count, threads, status)
      type(solid_model), intent(inout) :: model
      integer, intent(in) :: count
      integer, intent(in) :: threads
      integer(c_int), intent(out) :: status
      type(patch), allocatable :: found(:)
      integer :: n, k, failed

      allocate (found(model%pairs), stat=failed)
      status = merge(status_ok, status_out_of_memory, failed == 0)
      if (failed /= 0) return
      do n = 1, count
         call prepare(model)
         !$omp parallel do default(none) num_threads(threads) if(threads > 1) shared(model, found) private(k) &
         !$omp schedule(static)
         do k = 1, model%pairs
            call meet(model%set, model%pair(k)%part(1), model%pair(k)%part(2), found(k))
         end do
         !$omp end parallel do
         do k = 1, size(model%set%item)
            call predict(model, model%set%item(k))
         end do
         do k = 1, model%pairs
            if (found(k)%points == 0 .and. model%pair(k)%points == 0) cycle
            associate (a => model%set%item(model%set%parts(model%pair(k)%part(1))%owner), &
                       b => model%set%item(model%set%parts(model%pair(k)%part(2))%owner))
               call act(model%law(model%pair(k)%law), model%kick, model%drift, found(k), a, b, model%pair(k))
            end associate
         end do
         do k = 1, size(model%set%item)
            call move(model, model%set%item(k))
         end do
         do k = 1, size(model%set%parts)
            if (.not. model%set%item(model%set%parts(k)%owner)%fixed) call place(model%set, k)
         end do
         model%drift = model%step
         model%t = model%t + model%step
         model%steps = model%steps + 1
         if (model%stale) return
      end do
   end subroutine advance

   !> Body force of this step
   subroutine prepare(model)
      type(solid_model), intent(inout) :: model
      real(wp) :: ground(2), half
      half = 0.5_wp * model%step
      model%kick = 0.5_wp * model%drift + half
      model%pull_before = model%pull
      model%pull = model%gravity
      if (.not. model%shaking) return
      call mean_acceleration(model%load%ground, model%segment, model%t - 0.5_wp * model%drift, model%t + half, ground)
      model%pull = model%pull - ground(1) * model%way - [0.0_wp, 0.0_wp, ground(2)]
   end subroutine prepare

   !> Velocity that follows from the forces of the last step; clears the forces
   pure subroutine predict(model, b)
      type(solid_model), intent(in) :: model
      type(body), intent(inout) :: b
      if (b%fixed) return
      b%spin = spin_of(b, b%swing)
      b%p = b%v + model%kick * (b%force * b%inverse_mass + model%pull)
      b%pspin = spin_of(b, b%swing + model%kick * b%moment)
      b%work = b%work + 0.5_wp * model%drift * b%mass &
         * dot_product(model%pull + model%pull_before - 2.0_wp * model%gravity, b%v)
      b%force = 0.0_wp
      b%moment = 0.0_wp
   end subroutine predict

   !> Velocity and place after the step
   pure subroutine move(model, b)
      type(solid_model), intent(inout) :: model
      type(body), intent(inout) :: b
      if (b%fixed) return
      b%v = b%v + model%kick * (b%force * b%inverse_mass + model%pull)
      b%swing = b%swing + model%kick * b%moment
      b%x = b%x + model%step * b%v
      call turn_freely(b, model%step)
      if (norm2(b%x - b%seen) + b%radius * norm2(b%turn - b%seen_turn) > 0.5_wp * model%skin) model%stale = .true.
   end subroutine move

   !> A step that is stable for all contacts that may close: 2 / omega, omega^2 bounded by the trace of each body's
   !> stiffness over its mass, twice as stiff where the neighbour moves too [s]
   subroutine critical_step(model, step)
      type(solid_model), intent(in) :: model
      real(wp), intent(out) :: step          !! [s]
      real(wp) :: greatest, stiff, arm(3), area, share, trace(size(model%set%item))
      type(patch) :: found
      integer :: k, i, side
      trace = 0.0_wp
      do k = 1, model%pairs
         call meet(model%set, model%pair(k)%part(1), model%pair(k)%part(2), found)
         associate (one => model%set%parts(model%pair(k)%part(1)), two => model%set%parts(model%pair(k)%part(2)))
            share = merge(1.0_wp, 2.0_wp, model%set%item(one%owner)%fixed .or. model%set%item(two%owner)%fixed)
            do side = 1, 2
               associate (b => model%set%item(merge(one%owner, two%owner, side == 1)))
                  if (b%fixed) cycle
                  do i = 1, found%points
                     area = found%area(i)
                     stiff = share * max(model%law(model%pair(k)%law)%normal_stiffness, &
                        model%law(model%pair(k)%law)%shear_stiffness) * area
                     arm = found%at(:, i) - b%x
                     associate (sum_of => trace(merge(one%owner, two%owner, side == 1)))
                        sum_of = sum_of + stiff * (b%inverse_mass + dot_product(arm, arm) / minval(b%inertia))
                     end associate
                  end do
               end associate
            end do
         end associate
      end do
      do k = 1, size(model%set%parts)   ! what touches nothing yet will land, on a face as large as it is
         associate (b => model%set%item(model%set%parts(k)%owner))
            if (b%fixed .or. trace(model%set%parts(k)%owner) > 0.0_wp) cycle
            area = model%set%parts(k)%size**2
            trace(model%set%parts(k)%owner) = 2.0_wp * model%law(1)%normal_stiffness * area &
               * (b%inverse_mass + b%radius**2 / minval(b%inertia))
         end associate
      end do
      greatest = maxval(trace)
      step = 2.0_wp / sqrt(max(greatest, tiny(1.0_wp)))
   end subroutine critical_step

   !> Energy that came from nowhere since the start [J]
   pure function energy_residual(energy, start) result(r)
      type(energy_terms), intent(in) :: energy
      type(energy_terms), intent(in) :: start
      real(wp) :: r
      r = (energy%leapfrog - start%leapfrog) + (energy%potential - start%potential) + (energy%elastic - start%elastic) &
         + (energy%friction - start%friction) + (energy%damping - start%damping) - (energy%work - start%work)
   end function energy_residual

   !> Ledger at the time of the last forces: leap-frog keeps m v(n-1/2) v(n+1/2) / 2 plus the energy of linear springs
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
         now%potential = now%potential - b%mass * dot_product(model%gravity, b%x - model%drift * b%v - b%rest)
         now%work = now%work + b%work
      end do
      now%friction = model%lost(1)
      now%damping = model%lost(2)
      do k = 1, model%pairs
         associate (pair => model%pair(k))
            now%elastic = now%elastic + elastic_energy(model%law(pair%law), pair)
            now%friction = now%friction + pair%friction_loss
            now%damping = now%damping + pair%damping_loss
            now%work = now%work + pair%support_work
         end associate
      end do
   end function energy_now

end module dem3_model
